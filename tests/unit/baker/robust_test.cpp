// Edge cases of the input: each has a defined result.
#include "core/error.h"
#include "maps.h"
#include "shared/limits.h"
#include <filesystem>

namespace lumel::baker {
namespace {
using namespace test;

void expectLobes(const ReflectanceMips& mips)
{
    for (const Level& level : mips.levels)
        for (size_t i = 0; i < level.texels.size(); i += kChannels) {
            const float* t = &level.texels[i];
            for (int c = 0; c < kChannels; ++c)
                ASSERT_TRUE(std::isfinite(t[c])) << "channel " << c;
            ASSERT_LT(t[kNx] * t[kNx] + t[kNy] * t[kNy], 1.0f);
            ASSERT_GT(t[kSxx] * t[kSyy], t[kSxy] * t[kSxy]);
            const float mean = 0.5f * (t[kSxx] + t[kSyy]);
            const float radius = std::hypot(0.5f * (t[kSxx] - t[kSyy]), t[kSxy]);
            ASSERT_LE(mean + radius, 1.001f / shared::kMinPower) << "power below the documented floor";
            ASSERT_GE(mean - radius, 0.99f / shared::kMaxPower);
            for (int c = kKsR; c <= kError; ++c)
                ASSERT_GE(t[c], 0.0f);
        }
}
} // namespace

TEST(Robust, EveryPowerOverEverySlopeGivesLobes)
{
    for (const float power : {0.0f, 1.0f, 1.5f, 8.0f, 60.0f, 1000.0f, 10000.0f, 1e9f})
        for (const float slope : {0.0f, 1e-5f, 0.05f, 0.5f, 5.0f, 500.0f})
            for (const Model model : {Model::ashikhminShirley, Model::blinnPhong}) {
                Options options;
                options.model = model;
                expectLobes(bake(normalMaps(noiseNormals(16, 16, slope, 8), power), options));
            }
}

TEST(Robust, ConstantHeightsAreFlat)
{
    for (const float height : {0.0f, 1.0f, -1e6f}) {
        const ReflectanceMips mips = bake(heightMaps(constantImage(9, 5, {height}), 0.1f, 70.0f), {});
        for (const Level& level : mips.levels) {
            EXPECT_EQ(meanOf(level, kNx), 0.0);
            EXPECT_EQ(meanOf(level, kError), 0.0);
            EXPECT_NEAR(meanOf(level, kSxx), 1.0 / 70.0, 1e-6);
        }
    }
}

TEST(Robust, AllBlackMapsAreDefined)
{
    // A black normal map decodes to (-1, -1, -1): below the horizon, brought back above it.
    expectLobes(bake(normalMaps(constantImage(8, 8, {0.0f, 0.0f, 0.0f}), 50.0f), {}));
    Maps maps = normalMaps(noiseNormals(8, 8, 0.2f, 1), 50.0f);
    maps.roughness = constantImage(8, 8, {0.0f});
    maps.specular = constantImage(8, 8, {0.0f, 0.0f, 0.0f});
    maps.diffuse = constantImage(8, 8, {0.0f});
    const ReflectanceMips mips = bake(maps, {});
    expectLobes(mips);
    EXPECT_EQ(meanOf(mips.levels.back(), kKsR), 0.0);
}

TEST(Robust, SingleTexelsAndLinesBake)
{
    for (const glm::ivec2 size : {glm::ivec2(1, 1), {1, 33}, {33, 1}, {2, 1}}) {
        expectLobes(bake(heightMaps(bumps(size.x, size.y), 0.2f, 90.0f), {}));
        Maps clamped = heightMaps(bumps(size.x, size.y), 0.2f, 90.0f);
        clamped.wrap = Wrap::clamp;
        expectLobes(bake(clamped, {}));
    }
}

TEST(Robust, AlphaChannelsAreIgnored)
{
    const Image rgb = noiseNormals(16, 16, 0.2f, 3);
    Image rgba(16, 16, 4);
    for (size_t i = 0; i < 256; ++i) {
        std::copy_n(&rgb.pixels[i * 3], 3, &rgba.pixels[i * 4]);
        rgba.pixels[i * 4 + 3] = 0.0f;
    }
    EXPECT_EQ(bake(normalMaps(rgb, 50.0f), {}).levels[2].texels,
              bake(normalMaps(rgba, 50.0f), {}).levels[2].texels);
}

TEST(Robust, SpecularBeyondHalfFloatIsCappedNotInfinite)
{
    Maps maps = normalMaps(noiseNormals(8, 8, 0.2f, 4), 50.0f);
    maps.specularConstant = glm::vec3(1e30f);
    const ReflectanceMips mips = bake(maps, {});
    expectLobes(mips);
    EXPECT_LE(meanOf(mips.levels[0], kKsR), 65504.0);
}

TEST(Robust, AnisotropicBasesKeepTheirDirection)
{
    Maps maps = normalMaps(constantImage(16, 16, {0.5f, 0.5f, 1.0f}), 50.0f);
    maps.anisotropicPower = {500.0f, 20.0f};
    maps.tangentRotation = constantImage(1, 1, {0.25f}); // 45 degrees
    const ReflectanceMips mips = bake(maps, {});
    expectLobes(mips);
    const float* t = mips.levels.back().at(0, 0);
    EXPECT_NEAR(t[kSxx], t[kSyy], 1e-5f);
    // Sharp along (1, 1), broad along (-1, 1): S.xy = (1/500 - 1/20) / 2.
    EXPECT_NEAR(t[kSxy], 0.5f * (1.0f / 500.0f - 1.0f / 20.0f), 1e-4f);
    // All directions together lose the direction, not the lobe.
    maps.tangentRotation = Image(16, 16, 1);
    for (size_t i = 0; i < 256; ++i)
        maps.tangentRotation.pixels[i] = float(i) / 256.0f;
    const ReflectanceMips mixed = bake(maps, {});
    expectLobes(mixed);
    const float* m = mixed.levels.back().at(0, 0);
    EXPECT_NEAR(m[kSxx] / m[kSyy], 1.0f, 0.05f);
    EXPECT_NEAR(m[kSxy] / m[kSxx], 0.0f, 0.05f);
}

TEST(Robust, ReducedChainsAreTheUpperPartOfTheFullOne)
{
    const Maps maps = heightMaps(bumps(128, 64), 0.1f, 150.0f);
    const ReflectanceMips full = bake(maps, {});
    for (const int reduce : {1, 2, 4}) {
        Options options;
        options.reduce = reduce;
        const ReflectanceMips reduced = bake(maps, options);
        ASSERT_EQ(reduced.levels.size(), full.levels.size() - size_t(reduce));
        for (size_t l = 0; l < reduced.levels.size(); ++l) {
            const Level &a = reduced.levels[l], &b = full.levels[l + size_t(reduce)];
            ASSERT_EQ(a.width, b.width);
            ASSERT_EQ(a.height, b.height);
            EXPECT_NEAR(meanOf(a, kError), meanOf(b, kError), 2e-3 + 0.02 * meanOf(b, kError));
        }
    }
    Options options;
    options.reduce = 8;
    EXPECT_THROW(bake(maps, options), Error);
}
} // namespace lumel::baker
