#include "export/maps.h"
#include "sample.h"

namespace lumel::baker {
namespace {
using namespace test;

const ExportMap& named(const std::vector<ExportMap>& maps, const std::string& name)
{
    for (const ExportMap& map : maps)
        if (map.name == name)
            return map;
    throw std::runtime_error("no map " + name);
}

TEST(ExportMaps, MetalnessAndBaseColourComeBack)
{
    for (const float metal : {0.0f, 0.25f, 0.6f, 1.0f})
        for (const glm::vec3 colour :
             {glm::vec3(0.8f, 0.5f, 0.2f), glm::vec3(0.3f), glm::vec3(0.05f, 0.1f, 0.9f)}) {
            const glm::vec3 f0 = glm::mix(glm::vec3(0.04f), colour, metal);
            const MetallicColour found = metallicColour(colour * (1.0f - metal) * 0.96f, f0);
            EXPECT_NEAR(found.metallic, metal, 1e-4f);
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(found.baseColour[c], colour[c], 1e-4f) << metal;
        }
}

TEST(ExportMaps, BlackAndBrightMaterialsStayInRange)
{
    for (const float diffuse : {0.0f, 0.5f, 3.0f})
        for (const float f0 : {0.0f, 0.02f, 0.04f, 1.0f, 4.0f}) {
            const MetallicColour found = metallicColour(glm::vec3(diffuse), glm::vec3(f0));
            EXPECT_TRUE(found.metallic >= 0.0f && found.metallic <= 1.0f);
            EXPECT_TRUE(found.baseColour.x >= 0.0f && found.baseColour.x <= 1.0f);
        }
}

TEST(ExportMaps, PackingsHoldTheSameValuesElsewhere)
{
    const auto levels = fitGgx(bake(unevenMaps(16, 8), {}), {});
    const auto gltf = makeMaps(levels, {.packing = Packing::gltf});
    const auto orm = makeMaps(levels, {.packing = Packing::orm});
    const auto unity = makeMaps(levels, {.packing = Packing::unity});
    const auto unreal = makeMaps(levels, {.packing = Packing::unreal});
    for (size_t l = 0; l < levels.size(); ++l)
        for (int y = 0; y < levels[l].height; ++y)
            for (int x = 0; x < levels[l].width; ++x) {
                const float roughness = roughnessOf(levels[l].at(x, y), false);
                const float* g = named(gltf, "metallic_roughness").levels[l].at(x, y);
                EXPECT_FLOAT_EQ(g[1], roughness);
                EXPECT_FLOAT_EQ(named(orm, "occlusion_roughness_metallic").levels[l].at(x, y)[0], 1.0f);
                EXPECT_FLOAT_EQ(named(orm, "occlusion_roughness_metallic").levels[l].at(x, y)[1], roughness);
                EXPECT_FLOAT_EQ(named(unity, "metallic_smoothness").levels[l].at(x, y)[3], 1.0f - roughness);
                EXPECT_FLOAT_EQ(named(unity, "metallic_smoothness").levels[l].at(x, y)[0], g[2]);
                EXPECT_FLOAT_EQ(*named(unreal, "roughness").levels[l].at(x, y), roughness);
                EXPECT_FLOAT_EQ(*named(unreal, "metallic").levels[l].at(x, y), g[2]);
            }
}

TEST(ExportMaps, LevelZeroHoldsTheMapsThatWereBaked)
{
    const Maps source = unevenMaps(16, 16);
    const auto maps = makeMaps(fitGgx(bake(source, {}), {}), {});
    for (size_t i = 0; i < 256; ++i) {
        EXPECT_NEAR(named(maps, "metallic_roughness").levels[0].pixels[3 * i + 1], source.roughness.pixels[i],
                    2e-3f);
        for (size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(named(maps, "normal").levels[0].pixels[3 * i + c], source.normal.pixels[3 * i + c],
                        2e-3f);
    }
}

TEST(ExportMaps, GreenDownMirrorsTheNormal)
{
    const auto levels = fitGgx(bake(unevenMaps(8, 8), {}), {});
    const auto up = makeMaps(levels, {}), down = makeMaps(levels, {.normalGreenUp = false});
    for (size_t i = 0; i < 64; ++i)
        EXPECT_NEAR(named(up, "normal").levels[0].pixels[3 * i + 1] +
                        named(down, "normal").levels[0].pixels[3 * i + 1],
                    1.0f, 1e-6f);
}

// KHR_materials_anisotropy: alpha along the direction is mix(alpha, 1, strength^2), across it roughness^2.
TEST(ExportMaps, AnisotropyIsThatOfTheExtension)
{
    GgxTexel texel;
    texel.shape.tangent = {0.0f, 1.0f, 0.0f};
    texel.shape.alphaT = 0.5f;
    texel.shape.alphaB = 0.09f;
    const glm::vec3 a = anisotropyOf(texel);
    const float alpha = roughnessOf(texel, true) * roughnessOf(texel, true);
    EXPECT_NEAR(alpha, 0.09f, 1e-6f);
    EXPECT_NEAR(alpha + (1.0f - alpha) * a.z * a.z, 0.5f, 1e-5f);
    EXPECT_NEAR(std::abs(a.y), 1.0f, 1e-6f);
}

TEST(ExportMaps, AnisotropyThatWasBakedComesBack)
{
    Maps source = unevenMaps(16, 16, 0.01f);
    source.roughness = constantImage(1, 1, {0.3f});
    source.anisotropy = constantImage(1, 1, {0.6f});
    source.tangentRotation = constantImage(1, 1, {0.25f});
    const auto maps = makeMaps(fitGgx(bake(source, {}), {.anisotropic = true}), {.anisotropic = true});
    const float* t = named(maps, "anisotropy").levels[0].at(3, 3);
    EXPECT_NEAR(t[0], 0.5f + 0.5f * std::sqrt(0.5f), 5e-3f);
    EXPECT_NEAR(t[1], 0.5f + 0.5f * std::sqrt(0.5f), 5e-3f);
    EXPECT_NEAR(t[2], 0.6f, 5e-3f);
}

} // namespace
} // namespace lumel::baker
