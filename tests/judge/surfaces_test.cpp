// Where textures are read, and what the surface is: wrap modes, transforms, UV sets, colours, tangent frames.
#include "subject.h"

namespace lumel::test {
namespace {

constexpr int kClamp = 33071, kMirror = 33648, kRepeat = 10497;

// A sheet whose UVs leave [0, 1] on all sides.
Shape wideSheet()
{
    Shape shape = sheet(4);
    for (glm::vec2& uv : shape.uvs)
        uv = uv * 2.4f - 0.7f;
    return shape;
}

void wrap(const char* name, int s, int t)
{
    Subject subject;
    subject.camera({0.4f, 0.5f, 2.4f}, {0, 0, 0});
    json material = {{"pbrMetallicRoughness",
                      {{"baseColorTexture", {{"index", subject.texture(patches(24, 6, 7), s, t)}}},
                       {"metallicFactor", 0.0},
                       {"roughnessFactor", 0.4}}}};
    material["emissiveFactor"] = {0.3, 0.3, 0.3};
    material["emissiveTexture"] = {{"index", subject.texture(patches(64, 8, 8), t, s)}};
    subject.place(wideSheet(), material);
    expectAgreement(name, subject);
}

TEST_F(Judge, RepeatAndMirror)
{
    wrap("wrap-repeat-mirror", kRepeat, kMirror);
}

TEST_F(Judge, MirrorAndClamp)
{
    wrap("wrap-mirror-clamp", kMirror, kClamp);
}

TEST_F(Judge, ClampAndRepeat)
{
    wrap("wrap-clamp-repeat", kClamp, kRepeat);
}

json transformed(int texture, json transform)
{
    return {{"index", texture}, {"extensions", {{"KHR_texture_transform", std::move(transform)}}}};
}

TEST_F(Judge, TextureTransform)
{
    Subject subject;
    subject.use("KHR_texture_transform");
    const json transform = {{"offset", {0.3, -0.2}}, {"rotation", 0.6}, {"scale", {2.0, 1.5}}};
    json material = subject.material(patches(1, 1, 0));
    material["pbrMetallicRoughness"]["baseColorTexture"] =
        transformed(subject.texture(patches(64, 8, 1)), transform);
    material["normalTexture"] = transformed(subject.texture(bumps(64, 2)), transform);
    Shape shape = sheet(4);
    shape.tangents.clear(); // to be made of the transformed UVs
    subject.camera({0.4f, 0.5f, 2.4f}, {0, 0, 0});
    subject.place(shape, material);
    expectAgreement("transform", subject);
}

// Maps of their own transforms, which are baked into one.
TEST_F(Judge, TransformsOfTheirOwn)
{
    Subject subject;
    subject.use("KHR_texture_transform");
    json material = subject.material(patches(1, 1, 0));
    material["normalTexture"] = {{"index", subject.texture(bumps(64, 2))}};
    material["pbrMetallicRoughness"]["baseColorTexture"] =
        transformed(subject.texture(patches(64, 8, 1)),
                    {{"rotation", 1.5707963}, {"offset", {0.25, 1.5}}, {"scale", {2, 2}}});
    material["emissiveFactor"] = {0.3, 0.3, 0.3};
    material["emissiveTexture"] =
        transformed(subject.texture(patches(32, 16, 3)), {{"offset", {0.5, 0.1}}, {"scale", {3, 3}}});
    subject.place(ball(), material);
    expectAgreement("transforms-own", subject);
}

TEST_F(Judge, SecondUvs)
{
    Subject subject;
    json material = subject.material(patches(64, 16, 1));
    material["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"] = 1;
    subject.place(ball(), material);
    expectAgreement("second-uvs", subject);
}

// Red to green to blue around the ball, and a share of white above.
Shape colouredBall(bool withAlpha)
{
    Shape shape = ball();
    for (const glm::vec3 p : shape.positions)
        shape.colours.push_back(
            glm::vec4(glm::clamp(0.5f + 0.5f * p, 0.0f, 1.0f), withAlpha ? 0.5f + 0.5f * p.x : 1.0f));
    return shape;
}

TEST_F(Judge, VertexColours)
{
    Subject subject;
    json material = subject.material(patches(32, 8, 1));
    Image metal = patches(256, 4, 2);
    for (size_t i = 0; i < metal.pixels.size(); ++i)
        metal.pixels[i] = i % 3 == 2 ? std::round(metal.pixels[i]) : 1.0f; // metal or not
    material["pbrMetallicRoughness"]["metallicRoughnessTexture"] = {{"index", subject.texture(metal)}};
    material["pbrMetallicRoughness"]["metallicFactor"] = 1.0;
    subject.place(colouredBall(false), material);
    expectAgreement("vertex-colours", subject, {.environment = 0.3f});
}

TEST_F(Judge, VertexColoursThatBlend)
{
    Subject subject;
    json material = subject.material(patches(32, 8, 1));
    material["alphaMode"] = "BLEND";
    subject.place(colouredBall(true), material);
    expectAgreement("vertex-colours-blend", subject);
}

json bumpy(Subject& subject, float scale = 1.0f)
{
    json material = subject.material(patches(16, 4, 1));
    material["normalTexture"] = {{"index", subject.texture(bumps(64, 2))}, {"scale", scale}};
    return material;
}

TEST_F(Judge, NormalMap)
{
    Subject subject;
    subject.place(ball(), bumpy(subject));
    expectAgreement("normal-map", subject);
}

TEST_F(Judge, NormalScale)
{
    for (const float scale : {0.3f, 1.8f}) {
        Subject subject;
        subject.place(ball(), bumpy(subject, scale));
        expectAgreement(fmt::format("normal-scale-{}", scale), subject);
    }
}

// What mirrors an object mirrors its bumps.
TEST_F(Judge, Mirrored)
{
    for (const bool ownTangents : {true, false}) {
        Subject subject;
        Shape shape = sheet(4);
        if (!ownTangents)
            shape.tangents.clear();
        subject.camera({0.4f, 0.5f, 2.4f}, {0, 0, 0});
        subject.place(shape, bumpy(subject), {{"scale", {-1, 1, 1}}});
        expectAgreement(fmt::format("mirrored-{}", int(ownTangents)), subject);
    }
}

// Half a tube that opens towards the eye: its outside on the right, its inside on the left.
Shape trough()
{
    Shape shape = sheet(24);
    for (size_t i = 0; i < shape.positions.size(); ++i) {
        const float angle = 2.6f * shape.positions[i].x;
        shape.positions[i] = {0.8f * std::sin(angle), shape.positions[i].y, 0.8f * std::cos(angle)};
        shape.normals[i] = {std::sin(angle), 0.0f, std::cos(angle)};
        shape.tangents[i] = {std::cos(angle), 0.0f, -std::sin(angle), 1.0f};
    }
    return shape;
}

TEST_F(Judge, DoubleSided)
{
    for (const bool bumps : {false, true}) {
        Subject subject;
        json material = bumps ? bumpy(subject) : subject.material(patches(16, 8, 1));
        material["doubleSided"] = true;
        subject.place(trough(), material, {{"rotation", {0, 0.94, 0, 0.34}}});
        expectAgreement(fmt::format("double-sided-{}", int(bumps)), subject);
    }
}

TEST_F(Judge, BackFacesAreNotSeen)
{
    Subject subject;
    subject.place(trough(), subject.material(patches(16, 8, 1)), {{"rotation", {0, 0.94, 0, 0.34}}});
    expectAgreement("single-sided", subject);
}

} // namespace
} // namespace lumel::test
