// Maps beside the reflectance: emission, occlusion, opacity, of another size than the base colour.
#include "subject.h"

namespace lumel::test {
namespace {

json info(int texture)
{
    return {{"index", texture}};
}

// A ball with a base colour and an emission of these sizes.
void emission(const char* name, int baseSize, int size)
{
    Subject subject;
    json material = subject.material(patches(baseSize, std::min(baseSize, 16), 1));
    material["emissiveFactor"] = {0.9, 0.7, 0.5};
    material["emissiveTexture"] = info(subject.texture(patches(size, std::min(size, 32), 2)));
    subject.place(ball(), material);
    expectAgreement(name, subject);
}

TEST_F(Judge, EmissionLargerThanTheBaseColour)
{
    emission("emission-larger", 8, 128);
}

TEST_F(Judge, EmissionSmallerThanTheBaseColour)
{
    emission("emission-smaller", 128, 8);
}

TEST_F(Judge, EmissionOfAConstantColour)
{
    emission("emission-alone", 1, 512);
}

TEST_F(Judge, EmissionThatIsNotSquare)
{
    Subject subject;
    json material = subject.material(patches(16, 16, 1));
    material["emissiveFactor"] = {1, 1, 1};
    const Image square = patches(128, 32, 2);
    Image flat(128, 16, 3);
    for (int y = 0; y < flat.height; ++y)
        std::copy_n(square.at(0, 8 * y), 3 * flat.width, flat.at(0, y));
    material["emissiveTexture"] = info(subject.texture(flat));
    subject.place(ball(), material);
    expectAgreement("emission-flat", subject);
}

// Under an environment, since occlusion dims nothing else.
void occlusion(const char* name, int baseSize, int size)
{
    Subject subject;
    json material = subject.material(patches(baseSize, std::min(baseSize, 8), 1));
    material["occlusionTexture"] = {{"index", subject.texture(patches(size, std::min(size, 32), 2))},
                                    {"strength", 0.8}};
    subject.place(ball(), material);
    expectAgreement(name, subject, {.environment = 0.6f});
}

TEST_F(Judge, OcclusionLargerThanTheBaseColour)
{
    occlusion("occlusion-larger", 8, 128);
}

TEST_F(Judge, OcclusionSmallerThanTheBaseColour)
{
    occlusion("occlusion-smaller", 128, 8);
}

TEST_F(Judge, OcclusionOfAFaintSky)
{
    Subject subject(false);
    // The sun stands behind the sheet: what is seen is its 4 % of sky.
    subject.light({{"type", "directional"}, {"intensity", 15.0}}, {0, 1, -1}, {0, 0, 0});
    json material = subject.material(patches(1, 1, 5));
    material["occlusionTexture"] = info(subject.texture(patches(64, 32, 2)));
    subject.place(sheet(), material);
    expectAgreement("occlusion-sky", subject);
}

// Emission and occlusion where the first set of UVs has nothing to say, on the second.
TEST_F(Judge, EmissiveOnTheSecondUvs)
{
    Subject subject;
    json material = subject.material(patches(32, 16, 1));
    material["emissiveFactor"] = {0.6, 0.6, 0.6};
    material["emissiveTexture"] = {{"index", subject.texture(patches(128, 32, 2))}, {"texCoord", 1}};
    material["occlusionTexture"] = {{"index", subject.texture(patches(16, 16, 3))}, {"texCoord", 1}};
    subject.place(ball(), material);
    expectAgreement("emissive-second-uvs", subject, {.environment = 0.4f});
}

// A ball before a lit sheet, its alpha in a base colour of this size, with a normal map of that one.
void opacity(const char* name, const char* mode, int size, int normalSize)
{
    Subject subject;
    const int cells = std::min(size, 16);
    // Of a constant colour the reflectance has one texel.
    json material = subject.material(normalSize == 0 ? holes(size, cells, 3) : patches(size, cells, 3, true));
    if (normalSize > 0)
        material["normalTexture"] = info(subject.texture(bumps(normalSize, 3)));
    material["alphaMode"] = mode;
    if (std::string(mode) == "MASK")
        material["alphaCutoff"] = 0.3;
    else
        material["pbrMetallicRoughness"]["baseColorFactor"] = {1.0, 1.0, 1.0, 0.7};
    subject.place(ball(), material);
    subject.place(sheet(), subject.material(patches(16, 16, 4)),
                  {{"translation", {0, 0, -1.5}}, {"scale", {3, 3, 3}}});
    expectAgreement(name, subject);
}

TEST_F(Judge, MaskOfAConstantColour)
{
    opacity("mask-alone", "MASK", 64, 0);
}

TEST_F(Judge, MaskLargerThanTheNormals)
{
    opacity("mask-larger", "MASK", 64, 16);
}

TEST_F(Judge, MaskSmallerThanTheNormals)
{
    opacity("mask-smaller", "MASK", 16, 128);
}

TEST_F(Judge, BlendOfAConstantColour)
{
    opacity("blend-alone", "BLEND", 64, 0);
}

TEST_F(Judge, BlendSmallerThanTheNormals)
{
    opacity("blend-smaller", "BLEND", 16, 128);
}

constexpr Shading kShadings[] = {Shading::reference, Shading::forward, Shading::tsl};

// A dark constant colour with an emission map finer than the pixels.
TEST_F(Judge, EveryShadingShowsFineEmission)
{
    for (const Shading shading : kShadings) {
        Subject subject;
        subject.camera({0.2f, 0.3f, 2.6f}, {0, 0, 0});
        json material = {{"pbrMetallicRoughness",
                          {{"baseColorFactor", {0.02, 0.02, 0.02, 1.0}}, {"metallicFactor", 0.0}}}};
        material["emissiveFactor"] = {1, 1, 1};
        material["emissiveTexture"] = info(subject.texture(patches(512, 16, 2)));
        subject.place(sheet(), material);
        expectAgreement(fmt::format("fine-emission-{}", int(shading)), subject, {.shading = shading},
                        shading == Shading::reference ? 40.0 : 30.0);
    }
}

// The same where lumels lie elsewhere than the maps do: these repeat, and emission has UVs of its own.
TEST_F(Judge, EveryShadingShowsFineEmissionOnItsOwnUvs)
{
    for (const Shading shading : kShadings) {
        Subject subject;
        subject.camera({0.2f, 0.3f, 2.6f}, {0, 0, 0});
        json material = subject.material(patches(8, 8, 1));
        material["emissiveFactor"] = {1, 1, 1};
        material["emissiveTexture"] = {{"index", subject.texture(patches(256, 8, 2))}, {"texCoord", 1}};
        Shape shape = sheet();
        for (glm::vec2& uv : shape.uvs)
            uv *= 2.0f;
        for (glm::vec2& uv : shape.secondUvs)
            uv *= 1.5f;
        subject.place(shape, material);
        expectAgreement(fmt::format("own-emission-{}", int(shading)), subject, {.shading = shading},
                        shading == Shading::reference ? 40.0 : 30.0);
    }
}

// A cut-out of a constant colour: all of it is drawn forward, by its opacity's own level.
TEST_F(Judge, EveryShadingShowsFineHoles)
{
    for (const Shading shading : kShadings) {
        Subject subject;
        subject.camera({0.2f, 0.3f, 2.6f}, {0, 0, 0});
        json material = subject.material(holes(64, 8, 3));
        material["alphaMode"] = "MASK";
        subject.place(sheet(), material);
        expectAgreement(fmt::format("fine-holes-{}", int(shading)), subject, {.shading = shading},
                        shading == Shading::reference ? 40.0 : 28.0);
    }
}

} // namespace
} // namespace lumel::test
