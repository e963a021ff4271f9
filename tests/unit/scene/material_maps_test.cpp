#include "gltf_builder.h"
#include "scene/material_maps.h"
#include "shared/energy.h"

namespace lumel::scene {
namespace {

// Scenes whose images are real PNG files in memory.
struct MaterialMaps : testing::Test {
    TemporaryFolder folder;
    Scene scene;
    Material material;

    // Value of channel c at (x, y), in steps of 1/255.
    template<class Value>
    int addImage(int width, int height, int channels, const Value& value)
    {
        Image image(width, height, channels);
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x)
                for (int c = 0; c < channels; ++c)
                    image.at(x, y)[c] = float(value(x, y, c)) / 255.0f;
        writeImage(folder / "image.png", image);
        const std::string bytes = readText(folder / "image.png");
        SceneImage entry;
        entry.name = "image" + std::to_string(scene.images.size()) + ".png";
        for (char byte : bytes)
            entry.bytes.push_back(std::byte(byte));
        scene.images.push_back(std::move(entry));
        return int(scene.images.size()) - 1;
    }
};

constexpr float kLeft = 0.96f; // to diffuse reflection by a dielectric of ior 1.5

void expectNear(const float* actual, glm::vec3 expected, float tolerance = 1e-5f)
{
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(actual[c], expected[c], tolerance);
}

TEST_F(MaterialMaps, ConstantsGiveOneTexel)
{
    material.baseColor = {0.8f, 0.4f, 0.2f, 1.0f};
    material.metallic = 0.25f;
    material.roughness = 0.5f;
    const baker::Maps maps = reflectanceMaps(scene, material);
    EXPECT_TRUE(maps.specular.empty());
    EXPECT_TRUE(maps.diffuse.empty());
    EXPECT_TRUE(maps.roughness.empty());
    EXPECT_EQ(maps.normal.width * maps.normal.height, 1);
    expectNear(&maps.specularConstant.x, {0.23f, 0.13f, 0.08f}); // 0.04 + (c - 0.04) / 4
    expectNear(&maps.diffuseConstant.x, kLeft * glm::vec3(0.6f, 0.3f, 0.15f));
    EXPECT_FLOAT_EQ(maps.powerConstant, shared::powerFromRoughness(0.5f));
    EXPECT_FALSE(emissiveVaries(material));
    const Image emissive = emissiveImage(scene, material);
    EXPECT_EQ(emissive.width * emissive.height, 1);
    expectNear(emissive.pixels.data(), {0, 0, 0});
    EXPECT_EQ(emissive.pixels[3], 1.0f);
}

TEST_F(MaterialMaps, MapsWithTransformsOfTheirOwnAreMoved)
{
    material.metallic = 0.0f;
    material.baseColorImage = addImage(4, 2, 3, [](int x, int y, int c) {
        return c == 0 ? 60 * x : c == 1 ? 100 * y : 0;
    });
    const auto texels = [&] { return reflectanceMaps(scene, material).diffuse; };
    const Image still = texels();
    // At u + 1/2 the map shows its other half.
    material.baseColorUv.offset = {0.5f, 0.0f};
    const Image shifted = texels();
    ASSERT_EQ(shifted.width, 4);
    ASSERT_EQ(shifted.height, 2);
    for (int y = 0; y < 2; ++y)
        for (int x = 0; x < 4; ++x)
            expectNear(shifted.at(x, y), glm::vec3(still.at((x + 2) % 4, y)[0], still.at(x, y)[1], 0.0f),
                       1e-4f);
    // Relative to where the other maps are read: the same twice is nothing.
    material.uv.offset = {0.5f, 0.0f};
    EXPECT_EQ(texels().pixels, still.pixels);
    // Repeated twice across, mirrored on the way: u runs 0 to 2.
    material.uv = {};
    material.baseColorUv = {.scale = {2.0f, 1.0f}, .wrapU = Wrap::mirror};
    const Image twice = texels();
    ASSERT_EQ(twice.width, 8);
    for (int x = 0; x < 8; ++x)
        expectNear(twice.at(x, 0), glm::vec3(still.at(x < 4 ? x : 7 - x, 0)[0], still.at(0, 0)[1], 0.0f),
                   1e-4f);
    // Another set cannot be moved.
    material.baseColorUv = {.set = 1, .scale = {2.0f, 1.0f}};
    EXPECT_EQ(texels().pixels, still.pixels);
    // Nor one without extent.
    material.uv.scale = {0.0f, 1.0f};
    material.baseColorUv = {};
    EXPECT_EQ(texels().pixels, still.pixels);
}

TEST_F(MaterialMaps, SpecularAndAnisotropyMapsAreMovedToo)
{
    material.metallic = 0.0f;
    const auto ramp = [](int x, int, int) { return 60 * x; };
    const auto expectMoved = [&](int& slot, UvMapping& uv, const std::function<Image()>& map) {
        slot = addImage(4, 1, 4, ramp);
        const Image still = map();
        uv.offset = {0.5f, 0.0f};
        const Image shifted = map();
        ASSERT_EQ(shifted.width, 4);
        for (int x = 0; x < 4; ++x)
            EXPECT_NEAR(shifted.at(x, 0)[0], still.at((x + 2) % 4, 0)[0], 1e-4f);
        EXPECT_NE(still.at(0, 0)[0], still.at(2, 0)[0]);
        slot = -1;
    };
    const auto specular = [&] { return reflectanceMaps(scene, material).specular; };
    expectMoved(material.specularImage, material.specularUv, specular);
    expectMoved(material.specularColorImage, material.specularColorUv, specular);
    material.anisotropy = 1.0f;
    material.roughness = 0.4f;
    expectMoved(material.anisotropyImage, material.anisotropyUv,
                [&] { return reflectanceMaps(scene, material).anisotropy; });
}

TEST_F(MaterialMaps, ColoursAreDecodedFromSrgbAndMultiplied)
{
    material.metallic = 0.0f;
    material.baseColor = {0.5f, 1.0f, 1.0f, 1.0f};
    material.baseColorImage = addImage(2, 1, 3, [](int x, int, int) { return x ? 188 : 55; });
    const baker::Maps maps = reflectanceMaps(scene, material);
    ASSERT_EQ(maps.diffuse.width, 2);
    // IEC 61966-2-1: 188/255 encodes 0.5029, 55/255 encodes 0.0382
    expectNear(maps.diffuse.at(1, 0), kLeft * glm::vec3(0.25144f, 0.50289f, 0.50289f), 1e-4f);
    expectNear(maps.diffuse.at(0, 0), kLeft * glm::vec3(0.01910f, 0.03820f, 0.03820f), 1e-4f);
    EXPECT_TRUE(maps.specular.empty()) << "glossy plastic everywhere";
    expectNear(&maps.specularConstant.x, glm::vec3(0.04f));
}

TEST_F(MaterialMaps, RoughnessIsGreenAndMetalnessBlueOfTheOtherImage)
{
    material.roughness = 0.5f;
    material.metallic = 1.0f;
    material.baseColor = {0.9f, 0.6f, 0.3f, 1.0f};
    // red is occlusion in many files and must not matter
    material.metallicRoughnessImage = addImage(2, 2, 3, [](int x, int y, int c) {
        return c == 0 ? 77 : c == 1 ? 51 + 102 * x : 255 * y;
    });
    const baker::Maps maps = reflectanceMaps(scene, material);
    ASSERT_EQ(maps.roughness.width, 2);
    EXPECT_NEAR(*maps.roughness.at(0, 0), 0.1f, 1e-5f);
    EXPECT_NEAR(*maps.roughness.at(1, 1), 0.3f, 1e-5f);
    expectNear(maps.specular.at(0, 0), glm::vec3(0.04f));
    expectNear(maps.specular.at(0, 1), {0.9f, 0.6f, 0.3f});
    expectNear(maps.diffuse.at(0, 0), kLeft * glm::vec3(0.9f, 0.6f, 0.3f));
    expectNear(maps.diffuse.at(0, 1), {0, 0, 0});
}

TEST_F(MaterialMaps, ImagesOfOneMaterialMayDifferInSize)
{
    material.baseColorImage = addImage(8, 4, 3, [](int, int, int) { return 255; });
    material.metallicRoughnessImage = addImage(2, 2, 3, [](int, int y, int) { return 255 * y; });
    material.normalImage = addImage(3, 5, 3, [](int, int, int c) { return c == 2 ? 255 : 128; });
    const baker::Maps maps = reflectanceMaps(scene, material);
    EXPECT_EQ(maps.specular.width, 8);
    EXPECT_EQ(maps.specular.height, 4);
    EXPECT_EQ(maps.normal.width, 3);
    // Rows 0 to 3 of 4 fall on the lower map at -0.25, 0.25, 0.75, 1.25 of its two rows, repeated.
    expectNear(maps.diffuse.at(0, 0), glm::vec3(kLeft * 0.75f));
    expectNear(maps.diffuse.at(0, 1), glm::vec3(kLeft * 0.75f));
    expectNear(maps.diffuse.at(0, 2), glm::vec3(kLeft * 0.25f));
}

// Half of white and half of black is half the light, not the middle of the encoding, which is a fifth of it.
TEST_F(MaterialMaps, ColoursAreDecodedBeforeTheyAreResampled)
{
    const auto blackAndWhite = [](int x, int, int) { return x == 0 ? 0 : 255; };
    const auto any = [](int x, int, int) { return 50 * x; };
    material.baseColorImage = material.emissiveImage = addImage(2, 1, 3, blackAndWhite);
    material.metallicRoughnessImage = material.occlusionImage = addImage(6, 1, 3, any);
    material.metallic = 0.0f;
    material.emissive = glm::vec3(1.0f);
    const baker::Maps maps = reflectanceMaps(scene, material);
    ASSERT_EQ(maps.diffuse.width, 6);
    const Image emissive = emissiveImage(scene, material);
    ASSERT_EQ(emissive.width, 6);
    // Centres of six texels in two: the second lies on the black one, the third a third of the way to white.
    for (const auto& [image, white] : {std::pair(&maps.diffuse, kLeft), {&emissive, 1.0f}}) {
        expectNear(image->at(1, 0), glm::vec3(0.0f));
        expectNear(image->at(2, 0), glm::vec3(white / 3.0f));
        expectNear(image->at(3, 0), glm::vec3(2.0f * white / 3.0f));
        expectNear(image->at(4, 0), glm::vec3(white));
    }
}

TEST_F(MaterialMaps, ImagesOfOneValueBecomeConstants)
{
    material.baseColorImage = addImage(16, 16, 3, [](int, int, int) { return 255; });
    material.metallicRoughnessImage = addImage(16, 16, 3, [](int, int, int c) { return c == 1 ? 51 : 0; });
    const baker::Maps maps = reflectanceMaps(scene, material);
    EXPECT_TRUE(maps.diffuse.empty());
    EXPECT_TRUE(maps.specular.empty());
    EXPECT_TRUE(maps.roughness.empty());
    EXPECT_FLOAT_EQ(maps.powerConstant, shared::powerFromRoughness(0.2f));
}

TEST_F(MaterialMaps, GreyImagesCountAsColours)
{
    material.metallic = 0.0f;
    material.baseColorImage = addImage(2, 1, 1, [](int x, int, int) { return 255 * x; });
    const baker::Maps maps = reflectanceMaps(scene, material);
    expectNear(maps.diffuse.at(1, 0), glm::vec3(kLeft));
}

TEST_F(MaterialMaps, HeightsReplaceNormalsAndPowerTheRoughness)
{
    material.normalImage = addImage(2, 2, 3, [](int, int, int) { return 128; });
    material.heightImage = addImage(4, 4, 1, [](int x, int, int) { return 60 * x; });
    material.heightScale = 0.05f;
    material.power = 250.0f;
    const baker::Maps maps = reflectanceMaps(scene, material);
    EXPECT_TRUE(maps.normal.empty());
    EXPECT_EQ(maps.height.width, 4);
    EXPECT_FLOAT_EQ(maps.heightScale, 0.05f);
    EXPECT_FLOAT_EQ(maps.powerConstant, 250.0f);
}

TEST_F(MaterialMaps, EmissiveHoldsEmissionAndOcclusion)
{
    material.emissive = {2.0f, 0.0f, 4.0f};
    material.emissiveImage = addImage(2, 1, 3, [](int x, int, int) { return 255 * x; });
    material.occlusionImage = addImage(2, 1, 3, [](int x, int, int c) { return c == 0 ? 255 - 153 * x : 9; });
    material.occlusionStrength = 0.5f;
    EXPECT_TRUE(emissiveVaries(material));
    const Image emissive = emissiveImage(scene, material);
    ASSERT_EQ(emissive.channels, 4);
    expectNear(emissive.at(0, 0), {0, 0, 0});
    expectNear(emissive.at(1, 0), {2, 0, 4});
    EXPECT_NEAR(emissive.at(0, 0)[3], 1.0f, 1e-5f);
    EXPECT_NEAR(emissive.at(1, 0)[3], 0.7f, 1e-5f); // 1 + 0.5 (0.4 - 1)
}

TEST_F(MaterialMaps, IorAndSpecularSetTheDielectricReflectance)
{
    const auto expectKs = [&](glm::vec3 expected) {
        const baker::Maps maps = reflectanceMaps(scene, material);
        expectNear(&maps.specularConstant.x, expected);
    };
    material.metallic = 0.0f;
    material.ior = 1.33f; // water: (0.33 / 2.33)^2 = 0.020059
    expectKs(glm::vec3(0.020059f));
    material.ior = 0.0f; // by the extension's definition a mirror
    expectKs(glm::vec3(1.0f));
    material.ior = 1.5f;
    material.specular = 0.5f;
    material.specularColor = {2.0f, 1.0f, 50.0f};
    expectKs({0.04f, 0.02f, 0.5f}); // min(0.04 * 50, 1) / 2
    material.metallic = 1.0f;       // metals do not care
    material.baseColor = {0.9f, 0.8f, 0.7f, 1.0f};
    expectKs({0.9f, 0.8f, 0.7f});
}

TEST_F(MaterialMaps, SpecularImagesMultiply)
{
    material.metallic = 0.0f;
    material.specularImage = addImage(2, 1, 4, [](int x, int, int c) { return c == 3 ? 255 - 204 * x : 9; });
    material.specularColorImage = addImage(2, 1, 3, [](int, int, int c) { return c == 0 ? 188 : 255; });
    const baker::Maps maps = reflectanceMaps(scene, material);
    ASSERT_EQ(maps.specular.width, 2);
    expectNear(maps.specular.at(0, 0), {0.04f * 0.50289f, 0.04f, 0.04f}, 1e-5f); // 188 encodes 0.50289
    expectNear(maps.specular.at(1, 0), {0.008f * 0.50289f, 0.008f, 0.008f}, 1e-5f);
}

TEST_F(MaterialMaps, SpecularGlossiness)
{
    material.specularGlossiness = true;
    material.metallic = 0.0f;
    material.baseColor = {0.8f, 0.4f, 0.2f, 1.0f};
    material.specularColor = {0.25f, 0.5f, 0.0f};
    material.glossiness = 0.75f;
    const baker::Maps constant = reflectanceMaps(scene, material);
    expectNear(&constant.specularConstant.x, {0.25f, 0.5f, 0.0f});
    expectNear(&constant.diffuseConstant.x, {0.4f, 0.2f, 0.1f}); // times 1 - max(specular)
    EXPECT_FLOAT_EQ(constant.powerConstant, shared::powerFromRoughness(0.25f));
    material.metallicRoughnessImage =
        addImage(2, 1, 4, [](int x, int, int c) { return c == 3 ? 255 - 153 * x : 188; });
    const baker::Maps maps = reflectanceMaps(scene, material);
    EXPECT_NEAR(*maps.roughness.at(0, 0), 0.25f, 1e-5f);
    EXPECT_NEAR(*maps.roughness.at(1, 0), 0.7f, 1e-5f); // 1 - 0.75 * 0.4
    expectNear(&maps.specularConstant.x, {0.125722f, 0.251445f, 0.0f}, 1e-5f);
}

// alpha along the direction is mix(alpha, 1, strength^2), alpha = roughness^2.
TEST_F(MaterialMaps, AnisotropyWidensTheLobeAlongItsDirection)
{
    material.roughness = 0.5f;
    material.anisotropy = 0.6f;
    material.anisotropyRotation = glm::radians(-45.0f);
    const baker::Maps maps = reflectanceMaps(scene, material);
    const float along = 0.25f + 0.75f * 0.36f; // 0.52
    EXPECT_NEAR(maps.anisotropicPower.x, shared::powerFromRoughness(std::sqrt(along)), 1e-4f);
    EXPECT_NEAR(maps.anisotropicPower.y, shared::powerFromRoughness(0.5f), 1e-4f);
    ASSERT_EQ(maps.tangentRotation.pixels.size(), 1u);
    EXPECT_NEAR(maps.tangentRotation.pixels[0], 0.75f,
                1e-6f); // -45 degrees is 135 on the circle of half turns
    EXPECT_TRUE(maps.roughness.empty());
}

TEST_F(MaterialMaps, AnisotropyImagesHoldDirectionAndStrength)
{
    material.roughness = 0.5f;
    material.anisotropy = 1.0f;
    material.anisotropyRotation = glm::radians(90.0f);
    // Left: along +x at full strength; right: along +y at 0.4. Zero is 127.5, which 8 bits miss by a little.
    material.anisotropyImage = addImage(2, 1, 3, [](int x, int, int c) {
        return c == 0 ? (x ? 128 : 255) : c == 1 ? (x ? 255 : 128) : 255 - 153 * x;
    });
    const baker::Maps maps = reflectanceMaps(scene, material);
    EXPECT_NEAR(*maps.tangentRotation.at(0, 0), 0.5f, 2e-3f);
    const float right = *maps.tangentRotation.at(1, 0); // half a turn, which is none
    EXPECT_NEAR(std::min(right, 1.0f - right), 0.0f, 2e-3f);
    EXPECT_NEAR(*maps.anisotropy.at(0, 0), 1.0f, 1e-5f);
    EXPECT_NEAR(*maps.anisotropy.at(1, 0), 0.4f, 1e-5f);
    EXPECT_FLOAT_EQ(maps.roughness.pixels.at(0), 0.5f) << "the baker needs one";
}

TEST_F(MaterialMaps, UnlitReflectsNothing)
{
    material.unlit = true;
    material.emissive = {0.5f, 0.5f, 0.5f};
    material.metallicRoughnessImage = addImage(4, 4, 3, [](int x, int, int) { return 20 * x; });
    const baker::Maps maps = reflectanceMaps(scene, material);
    expectNear(&maps.specularConstant.x, glm::vec3(0.0f));
    expectNear(&maps.diffuseConstant.x, glm::vec3(0.0f));
    EXPECT_TRUE(maps.specular.empty() && maps.diffuse.empty() && maps.roughness.empty());
    EXPECT_NEAR(emissiveImage(scene, material).pixels[0], 0.5f, 1e-6f);
}

TEST_F(MaterialMaps, BrokenImagesAreNamed)
{
    material.normalImage = addImage(2, 2, 3, [](int, int, int) { return 128; });
    scene.images[0].bytes.resize(20);
    EXPECT_TRUE(contains(errorOf([&] { reflectanceMaps(scene, material); }), "image0.png"));
}

TEST(MipChain, EndsAtOneTexelAndKeepsTheMean)
{
    for (glm::ivec2 size :
         {glm::ivec2(8, 8), glm::ivec2(7, 5), glm::ivec2(1, 6), glm::ivec2(13, 1), glm::ivec2(1, 1)}) {
        Image image(size.x, size.y, 2);
        double mean = 0.0;
        for (size_t i = 0; i < image.pixels.size(); ++i) {
            image.pixels[i] = float((i * 37) % 11);
            if (i % 2 == 0)
                mean += double(image.pixels[i]) * 2.0 / double(image.pixels.size());
        }
        const auto levels = mipChain(image);
        int width = size.x, height = size.y;
        for (const Image& level : levels) {
            EXPECT_EQ(level.width, width);
            EXPECT_EQ(level.height, height);
            width = std::max(1, width / 2);
            height = std::max(1, height / 2);
        }
        EXPECT_EQ(levels.back().pixels.size(), 2u);
        EXPECT_NEAR(levels.back().pixels[0], mean, 1e-5);
    }
}

TEST(MipChain, EvenSizesAverageFourTexels)
{
    Image image(2, 2, 1);
    image.pixels = {1, 2, 3, 6};
    EXPECT_FLOAT_EQ(mipChain(image).at(1).pixels[0], 3.0f);
}

} // namespace
} // namespace lumel::scene
