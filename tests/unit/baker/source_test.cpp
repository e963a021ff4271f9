#include "baker/source.h"
#include "core/error.h"
#include "maps.h"
#include "shared/energy.h"
#include <limits>

namespace lumel::baker {
namespace {
using namespace test;

std::string messageOf(const Maps& maps)
{
    try {
        bake(maps, {});
    } catch (const Error& e) {
        return e.what();
    }
    return "";
}
} // namespace

TEST(Source, SlopesTiltNormalsDownhillWithGreenUp)
{
    // Height rises to the right and towards lower rows, 0.1 widths over the map.
    Image height(8, 8, 1);
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x)
            *height.at(x, y) = 0.1f * float(x) / 8.0f + 0.2f * float(y) / 8.0f;
    Maps maps = heightMaps(height, 1.0f, 50.0f);
    maps.wrap = Wrap::clamp;
    const ReflectanceMips mips = bake(maps, {});
    const glm::vec3 expected = glm::normalize(glm::vec3(-0.1f, 0.2f, 1.0f));
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x) {
            EXPECT_NEAR(mips.levels[0].at(x, y)[kNx], expected.x, 1e-6f);
            EXPECT_NEAR(mips.levels[0].at(x, y)[kNy], expected.y, 1e-6f);
        }
}

TEST(Source, GreenDownFlipsY)
{
    Maps maps = normalMaps(constantImage(2, 2, {0.5f, 0.8f, 0.9f}), 50.0f);
    const float up = bake(maps, {}).levels[0].at(0, 0)[kNy];
    maps.normalGreenUp = false;
    EXPECT_FLOAT_EQ(bake(maps, {}).levels[0].at(0, 0)[kNy], -up);
    EXPECT_GT(up, 0.3f);
}

TEST(Source, RoughnessMapsToPower)
{
    EXPECT_NEAR(shared::powerFromRoughness(0.5f), 14.1337f, 1e-3f); // 4 ln 2 / ln(1 + 3 / 16) - 2
    EXPECT_EQ(shared::powerFromRoughness(0.0f), shared::kMaxPower);
    EXPECT_EQ(shared::powerFromRoughness(1.0f), shared::kMinPower);
    Maps maps = normalMaps(constantImage(2, 2, {0.5f, 0.5f, 1.0f}), 7.0f);
    maps.roughness = constantImage(1, 1, {0.5f});
    EXPECT_NEAR(bake(maps, {}).levels[0].at(0, 0)[kSxx], 1.0f / shared::powerFromRoughness(0.5f), 1e-6f);
}

TEST(Source, SmallerMapsAreResampledToTheLargest)
{
    Maps maps = normalMaps(constantImage(4, 2, {0.5f, 0.5f, 1.0f}), 50.0f);
    maps.wrap = Wrap::clamp;
    maps.diffuse = Image(8, 8, 1);
    for (size_t i = 0; i < 64; ++i)
        maps.diffuse.pixels[i] = float(i % 8) / 7.0f;
    maps.specular = Image(2, 1, 3);
    maps.specular.pixels = {0.0f, 0.2f, 0.4f, 1.0f, 0.6f, 0.4f};
    const ReflectanceMips mips = bake(maps, {});
    ASSERT_EQ(mips.levels[0].width, 8);
    ASSERT_EQ(mips.levels[0].height, 8);
    EXPECT_FLOAT_EQ(mips.levels[0].at(7, 3)[kKdG], 1.0f);
    // A quarter texel left of the middle is F0 = 0.375.
    const auto ks = [](float f0) { return shared::specularStrength(glm::vec3(f0), {0.02f, 0.0f, 0.02f}).x; };
    EXPECT_NEAR(mips.levels[0].at(3, 0)[kKsR], ks(0.375f), 1e-6f);
    EXPECT_NEAR(mips.levels[0].at(0, 0)[kKsG], ks(0.2f), 1e-6f);
    EXPECT_NEAR(mips.levels[0].at(5, 5)[kKsB], ks(0.4f), 1e-6f);
    // The average of Kd is exact on a flat map.
    EXPECT_NEAR(mips.levels.back().at(0, 0)[kKdR], 0.5f, 1e-5f);
}

TEST(Source, UnusableMapsAreRefusedInOneLine)
{
    Maps none;
    EXPECT_NE(messageOf(none).find("no height map and no normal map"), std::string::npos);
    Maps both = normalMaps(constantImage(2, 2, {0.5f, 0.5f, 1.0f}), 50.0f);
    both.height = constantImage(2, 2, {0.5f});
    EXPECT_NE(messageOf(both).find("both"), std::string::npos);
    for (const float bad : {std::nanf(""), std::numeric_limits<float>::infinity()}) {
        Maps maps = heightMaps(bumps(4, 4), 0.1f, 50.0f);
        maps.height.pixels[6] = bad;
        EXPECT_EQ(messageOf(maps).find("height map: the texel at (2, 1)"), size_t(0));
        maps.height.pixels[6] = 0.0f;
        maps.powerConstant = bad;
        EXPECT_NE(messageOf(maps), "");
    }
    Maps scaleless = heightMaps(bumps(4, 4), 0.0f, 50.0f);
    EXPECT_NE(messageOf(scaleless).find("height scale"), std::string::npos);
    Maps grey = normalMaps(constantImage(4, 4, {0.5f}), 50.0f);
    EXPECT_NE(messageOf(grey).find("normal map: 1 channel"), std::string::npos);
    Maps broken = normalMaps(constantImage(4, 4, {0.5f, 0.5f, 1.0f}), 50.0f);
    broken.normal.pixels.pop_back();
    EXPECT_NE(messageOf(broken).find("no image"), std::string::npos);
    EXPECT_EQ(messageOf(heightMaps(bumps(4, 4), 0.1f, 50.0f)), "");
}

TEST(Source, HashFollowsEveryInputThatChangesTheResult)
{
    const Maps maps = heightMaps(bumps(4, 4), 0.1f, 50.0f);
    const std::string hash = sourceHash(maps, {});
    EXPECT_EQ(hash, sourceHash(heightMaps(bumps(4, 4), 0.1f, 50.0f), {}));
    Options threads;
    threads.threads = 1;
    EXPECT_EQ(hash, sourceHash(maps, threads));
    Options lean;
    lean.method = Method::lean;
    EXPECT_NE(hash, sourceHash(maps, lean));
    Maps other = maps;
    other.height.pixels[3] += 1e-3f;
    EXPECT_NE(hash, sourceHash(other, {}));
    other = maps;
    other.specularConstant.z = 0.5f;
    EXPECT_NE(hash, sourceHash(other, {}));
    other = maps;
    other.wrap = Wrap::clamp;
    EXPECT_NE(hash, sourceHash(other, {}));
}
} // namespace lumel::baker
