// Half-float chains: what the GPU reads is what a baked file holds.
#include "gltf_builder.h"
#include "scene/half_maps.h"
#include "scene/material_maps.h"
#include <random>

namespace lumel::scene {
namespace {

baker::ReflectanceMips bumps()
{
    std::mt19937 random(5);
    baker::Maps maps;
    maps.normal = Image(12, 8, 3);
    for (float& value : maps.normal.pixels)
        value = 0.3f + 0.4f * float(random() % 256) / 255.0f;
    maps.diffuseConstant = {0.1f, 0.2f, 0.3f};
    return baker::bake(maps, {.method = baker::Method::lean});
}

TEST(HalfMaps, ReflectanceIsThatOfABakedFile)
{
    const TemporaryFolder folder;
    const baker::ReflectanceMips mips = bumps();
    baker::writeExr(folder / "baked.exr", mips);
    const baker::ReflectanceMips read = baker::readExr(folder / "baked.exr");
    const Reflectance direct(mips), fromFile(read);
    for (const auto chain : {&Reflectance::normal, &Reflectance::specular, &Reflectance::diffuse})
        EXPECT_TRUE(std::ranges::equal((direct.*chain).bytes(), (fromFile.*chain).bytes()));
    ASSERT_EQ(direct.levels(), read.levels.size());
    for (size_t level = 0; level < read.levels.size(); ++level)
        for (int y = 0; y < read.levels[level].height; ++y)
            for (int x = 0; x < read.levels[level].width; ++x) {
                const auto texel = direct.at(level, x, y);
                EXPECT_TRUE(std::ranges::equal(
                    texel, std::span(read.levels[level].at(x, y), size_t(baker::kChannels))));
            }
}

TEST(HalfMaps, SecondLobesAreThereWhereAnyReflects)
{
    baker::ReflectanceMips mips = bumps();
    EXPECT_FALSE(Reflectance(mips).hasSecond());
    for (size_t l = 1; l < mips.levels.size(); ++l) {
        baker::Level& level = mips.levels[l];
        for (int i = 0; i < level.width * level.height; ++i)
            level.second.insert(level.second.end(), std::begin(baker::kNoSecondLobe),
                                std::end(baker::kNoSecondLobe));
    }
    EXPECT_FALSE(Reflectance(mips).hasSecond()) << "none reflects";
    // Power 10000 of a weak dielectric: no subnormal numbers.
    const std::array<float, baker::kSecondChannels> lobe = {0.3f,  -0.4f, 1e-4f, 2e-5f,
                                                            2e-4f, 0.03f, 0.04f, 0.05f};
    const int width = mips.levels[1].width;
    std::ranges::copy(lobe, mips.levels[1].second.begin() + ptrdiff_t(baker::kSecondChannels) * (width + 2));
    const Reflectance reflectance(mips);
    ASSERT_TRUE(reflectance.hasSecond());
    EXPECT_EQ(reflectance.second.size(), reflectance.normal.size(1));
    EXPECT_EQ(reflectance.second.levels(), reflectance.levels() - 1);
    const auto read = reflectance.secondAt(1, 2, 1), none = reflectance.secondAt(1, 1, 1);
    for (size_t c = 0; c < lobe.size(); ++c) {
        EXPECT_NEAR(read[c], lobe[c], 2e-3f * std::abs(lobe[c])) << c;
        EXPECT_EQ(none[c], baker::kNoSecondLobe[c]) << c;
        EXPECT_EQ(reflectance.secondAt(0, 0, 0)[c], baker::kNoSecondLobe[c]) << c;
    }
}

TEST(HalfMaps, MissingChannelsAreOneAndValuesStayFinite)
{
    Image grey(2, 1, 1);
    grey.pixels = {0.25f, 1e9f};
    const HalfChain chain(mipChain(grey));
    ASSERT_EQ(chain.levels(), 2u);
    EXPECT_EQ(chain.at(0, 0, 0), glm::vec4(0.25f, 1, 1, 1));
    EXPECT_EQ(chain.at(0, 1, 0), glm::vec4(65504.0f, 1, 1, 1));
    EXPECT_EQ(chain.at(1, 0, 0), glm::vec4(65504.0f, 1, 1, 1));
    EXPECT_EQ(chain.byteCount(), 3u * 8u);
    EXPECT_EQ(HalfChain::byteCount({2, 1}), 3u * 8u);
}

} // namespace
} // namespace lumel::scene
