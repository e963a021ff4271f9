// Properties of whole chains.
#include "baker/footprint.h"
#include "maps.h"
#include "oracle.h"
#include "shared/energy.h"
#include "shared/limits.h"

namespace lumel::baker {
namespace {
using namespace test;

Options with(Method method, Model model = Model::ashikhminShirley)
{
    Options options;
    options.method = method;
    options.model = model;
    return options;
}
} // namespace

TEST(Bake, LevelsHalveDownToOneTexelAtAnySize)
{
    for (const glm::ivec2 size : {glm::ivec2(1, 1), {1, 7}, {5, 1}, {37, 21}, {64, 16}, {100, 3}}) {
        const ReflectanceMips mips = bake(normalMaps(noiseNormals(size.x, size.y, 0.2f, 3), 60.0f), {});
        int w = size.x, h = size.y;
        ASSERT_EQ(int(mips.levels.size()), levelCount(w, h));
        for (const Level& level : mips.levels) {
            EXPECT_EQ(level.width, w);
            EXPECT_EQ(level.height, h);
            ASSERT_EQ(level.texels.size(), size_t(w) * size_t(h) * kChannels);
            for (const float v : level.texels)
                ASSERT_TRUE(std::isfinite(v));
            w = std::max(1, w / 2);
            h = std::max(1, h / 2);
        }
    }
}

TEST(Bake, FlatInputReturnsItselfExactlyOnAllLevels)
{
    for (const glm::ivec2 size : {glm::ivec2(64, 64), {45, 70}})
        for (const Model model : {Model::blinnPhong, Model::ashikhminShirley}) {
            Maps maps = normalMaps(constantImage(size.x, size.y, {0.6f, 0.35f, 0.93f}), 123.0f);
            maps.specularConstant = {0.9f, 0.5f, 0.1f};
            const ReflectanceMips mips = bake(maps, with(Method::fit, model));
            const float* base = mips.levels[0].at(0, 0);
            for (const Level& level : mips.levels)
                for (size_t i = 0; i < level.texels.size(); i += kChannels) {
                    for (int c = kNx; c <= kSyy; ++c)
                        ASSERT_EQ(level.texels[i + size_t(c)], base[c]);
                    for (int c = kKsR; c <= kKsB; ++c)
                        ASSERT_NEAR(level.texels[i + size_t(c)], base[c], 1e-6f);
                    ASSERT_EQ(level.texels[i + kError], 0.0f);
                }
        }
}

TEST(Bake, StatedErrorIsTheActualError)
{
    for (const Options& options : {exactly(), Options()}) {
        const ReflectanceMips mips = bake(normalMaps(noiseNormals(16, 16, 0.15f, 11), 100.0f), options);
        for (size_t l = 1; l < mips.levels.size(); ++l) {
            const float* t = mips.levels[l].at(0, 0);
            const OracleSums sums = oracleSums(lobesUnder(mips, l, 0, 0), oracleLobe(t), 300);
            EXPECT_NEAR(t[kError], sums.relativeError(t[kKsR]), 2e-3) << "level " << l;
            EXPECT_NEAR(t[kKsR], sums.gf / sums.ff, (2e-3 + options.precision) * t[kKsR]) << "level " << l;
        }
    }
}

TEST(Bake, OddSizesAverageExactAreas)
{
    // Three texels across: level 1 is one texel that covers all of them equally.
    Maps maps = normalMaps(constantImage(3, 1, {0.5f, 0.5f, 1.0f}), 50.0f);
    maps.diffuse = Image(3, 1, 1);
    maps.diffuse.pixels = {0.0f, 0.3f, 0.9f};
    EXPECT_NEAR(bake(maps, {}).levels[1].at(0, 0)[kKdR], 0.4f, 1e-6f);
    // Five across: two texels of 2.5 each.
    maps.normal = constantImage(5, 1, {0.5f, 0.5f, 1.0f});
    maps.diffuse = Image(5, 1, 1);
    maps.diffuse.pixels = {1.0f, 0.5f, 0.2f, 0.0f, 0.0f};
    const ReflectanceMips mips = bake(maps, {});
    ASSERT_EQ(mips.levels[1].width, 2);
    EXPECT_NEAR(mips.levels[1].at(0, 0)[kKdR], (1.0f + 0.5f + 0.1f) / 2.5f, 1e-6f);
    EXPECT_NEAR(mips.levels[1].at(1, 0)[kKdR], 0.1f / 2.5f, 1e-6f);
}

TEST(Bake, GroovesStayGrooves)
{
    const ReflectanceMips mips = bake(heightMaps(grooves(64, 64, 16), 0.008f, 400.0f), {});
    for (size_t l = 3; l < mips.levels.size(); ++l) {
        const float* t = mips.levels[l].at(0, 0);
        EXPECT_GT(t[kSxx] / t[kSyy], 5.0f) << "level " << l;
        EXPECT_NEAR(1.0f / t[kSyy], 400.0f, 40.0f) << "power along the grooves, level " << l;
    }
}

// A record as the renderer's own: grooves in rings, so that every far texel holds a piece of many, seen at
// another angle. Along them the base power 120 stays, across them it falls.
TEST(Bake, RecordsKeepTheirGroovesFarAway)
{
    const int n = 256;
    Image height(n, n, 1);
    for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) {
            const float r = std::hypot(float(x) - 0.5f * n, float(y) - 0.5f * n);
            *height.at(x, y) = std::cos(6.2831853f * r / 7.0f); // seven texels per groove
        }
    // Slopes of 0.32 rms: height * 2 pi / 7 * n / sqrt 2.
    const ReflectanceMips mips = bake(heightMaps(height, 0.5f / float(n), 120.0f), {});
    for (size_t l = 3; l <= 5; ++l) {
        const Level& level = mips.levels[l];
        for (const glm::vec2 at : {glm::vec2(0.25f, 0.5f), {0.5f, 0.25f}, {0.3f, 0.3f}, {0.8f, 0.45f}}) {
            const float* t = level.at(int(at.x * float(level.width)), int(at.y * float(level.height)));
            const float mean = 0.5f * (t[kSxx] + t[kSyy]);
            const float spread = std::hypot(0.5f * (t[kSxx] - t[kSyy]), t[kSxy]);
            EXPECT_GT((mean + spread) / (mean - spread), 5.0f)
                << "level " << l << " at " << at.x << ", " << at.y;
        }
    }
}

TEST(Bake, RotatingTheMapRotatesTheResult)
{
    const int n = 32;
    const Image original = noiseNormals(n, n, 0.25f, 5);
    Image turned(n, n, 3); // by 90 degrees to the left, as seen
    for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) {
            const float* from = original.at(n - 1 - y, x);
            float* to = turned.at(x, y);
            to[0] = 1.0f - from[1]; // N.x' = -N.y
            to[1] = from[0];        // N.y' = N.x
            to[2] = from[2];
        }
    const ReflectanceMips a = bake(normalMaps(original, 90.0f), {}), b = bake(normalMaps(turned, 90.0f), {});
    for (size_t l = 1; l < a.levels.size(); ++l) {
        const int size = a.levels[l].width;
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x) {
                const float* from = a.levels[l].at(size - 1 - y, x);
                const float* to = b.levels[l].at(x, y);
                ASSERT_NEAR(to[kError], from[kError], 2e-3f);
                ASSERT_NEAR(to[kNx], -from[kNy], 2e-2f) << "level " << l;
                ASSERT_NEAR(to[kNy], from[kNx], 2e-2f) << "level " << l;
            }
    }
}

TEST(Bake, PermutingTexelsUnderAPatchChangesNothing)
{
    Image normals = noiseNormals(8, 8, 0.2f, 9);
    const ReflectanceMips a = bake(normalMaps(normals, 120.0f), {});
    std::mt19937 random(4);
    for (int i = 63; i > 0; --i) {
        const int j = int(random() % unsigned(i + 1));
        std::swap_ranges(normals.at(i % 8, i / 8), normals.at(i % 8, i / 8) + 3, normals.at(j % 8, j / 8));
    }
    const ReflectanceMips b = bake(normalMaps(normals, 120.0f), {});
    const float *ta = a.levels[3].at(0, 0), *tb = b.levels[3].at(0, 0);
    EXPECT_NEAR(ta[kError], tb[kError], 1e-3f);
    EXPECT_NEAR(ta[kNx], tb[kNx], 3e-3f);
    EXPECT_NEAR(ta[kSxx], tb[kSxx], 0.02f * ta[kSxx]);
}

TEST(Bake, BlackSpecularStaysBlackWithoutError)
{
    Maps maps = normalMaps(noiseNormals(16, 16, 0.2f, 2), 50.0f);
    maps.specularConstant = glm::vec3(0.0f);
    const ReflectanceMips mips = bake(maps, {});
    for (const Level& level : mips.levels) {
        EXPECT_EQ(meanOf(level, kKsG), 0.0);
        EXPECT_EQ(meanOf(level, kError), 0.0);
    }
    EXPECT_GT(mips.levels.back().at(0, 0)[kSxx], 0.02f) << "the shape still widens";
}

TEST(Bake, ColouredSpecularIsProjectedPerChannel)
{
    Maps maps = normalMaps(constantImage(4, 4, {0.5f, 0.5f, 1.0f}), 50.0f);
    maps.specular = Image(2, 1, 3);
    maps.specular.pixels = {1.0f, 0.0f, 0.5f, 0.0f, 1.0f, 0.5f};
    const ReflectanceMips mips = bake(maps, {});
    const float* top = mips.levels.back().at(0, 0);
    for (const int c : {kKsR, kKsG, kKsB}) // one shape: the projection is the average
        EXPECT_NEAR(top[c], meanOf(mips.levels[0], c), 1e-3f) << c;
    EXPECT_NEAR(top[kKsB], shared::specularStrength(glm::vec3(0.5f), {0.02f, 0.0f, 0.02f}).x, 1e-3f);
}

TEST(Bake, ThreadsAndRepetitionChangeNothing)
{
    const Maps maps = heightMaps(bumps(96, 96), 0.1f, 80.0f);
    Options one;
    one.threads = 1;
    const ReflectanceMips a = bake(maps, {}), b = bake(maps, one);
    for (size_t l = 0; l < a.levels.size(); ++l)
        EXPECT_EQ(a.levels[l].texels, b.levels[l].texels) << "level " << l;
}

// Two copies of a map, one below the other, are baked in other batches than one. Broad lobes, tilted ones
// reach the rim; those of one power are summed on nodes, those of many kept as lists first.
TEST(Bake, TexelsDoNotDependOnTheBatchTheyAreIn)
{
    const auto twice = [](const Image& image) {
        Image tall(image.width, 2 * image.height, image.channels);
        for (size_t i = 0; i < tall.pixels.size(); ++i)
            tall.pixels[i] = image.pixels[i % image.pixels.size()];
        return tall;
    };
    for (const bool varying : {false, true}) {
        Maps one = normalMaps(noiseNormals(64, 64, 0.4f, 4), 12.0f);
        if (varying)
            one.roughness = noiseNormals(64, 64, 1.0f, 5);
        Maps two = one;
        two.normal = twice(one.normal);
        two.roughness = varying ? twice(one.roughness) : Image();
        const ReflectanceMips a = bake(one, {}), b = bake(two, {});
        for (size_t l = 0; l < a.levels.size(); ++l)
            for (const bool second : {false, true}) {
                std::vector<float> texels = second ? a.levels[l].second : a.levels[l].texels;
                texels.insert(texels.end(), texels.begin(), texels.end());
                EXPECT_EQ(texels, second ? b.levels[l].second : b.levels[l].texels)
                    << "level " << l << (varying ? ", varying gloss" : "");
            }
    }
}

// Real bakes as the first half of a larger job report exactly half of its progress.
TEST(Bake, ProgressReachesItsTotal)
{
    struct Case {
        const char* name;
        Maps maps;
        Options options;
    };
    Options reduced, bilinear, isotropic;
    reduced.reduce = 2;
    bilinear.reconstruction = Reconstruction::bilinear;
    isotropic.model = Model::blinnPhong;
    const Maps nested = heightMaps(bumps(64, 32), 0.1f, 80.0f);
    const Maps odd = normalMaps(noiseNormals(45, 37, 0.2f, 3), 60.0f);
    const Maps one = normalMaps(constantImage(1, 1, {0.5f, 0.5f, 1.0f}), 60.0f);
    for (const Case& c : {Case{"nested", nested, {}}, Case{"odd", odd, {}}, Case{"one texel", one, {}},
                          Case{"lean", nested, with(Method::lean)}, Case{"reduced", nested, reduced},
                          Case{"bilinear", nested, bilinear}, Case{"isotropic", odd, isotropic}}) {
        const size_t total = progressUnits(c.maps);
        ProgressMonitor monitor;
        monitorThisThread(&monitor);
        Progress progress(c.name, 2 * total);
        bake(c.maps, c.options, &progress);
        monitorThisThread(nullptr);
        EXPECT_EQ(monitor.share(), total > 0 ? 0.5f : 0.0f) << c.name << ": of " << total << " units";
    }
}
} // namespace lumel::baker
