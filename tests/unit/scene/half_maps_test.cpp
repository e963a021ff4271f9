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
