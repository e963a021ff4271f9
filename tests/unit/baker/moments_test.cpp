// What stands for several lobes between texels and taps: plain means, or moments.
#include "baker/moments.h"
#include "maps.h"
#include "oracle.h"
#include "shared/moments.h"

namespace lumel::baker {
namespace {
using namespace test;

// Means of N, S and Ks.
OracleLobe meanOf(const std::vector<OracleLobe>& lobes)
{
    OracleLobe m{};
    for (const OracleLobe& l : lobes) {
        m.nx += l.share * l.nx, m.ny += l.share * l.ny;
        m.sxx += l.share * l.sxx, m.sxy += l.share * l.sxy, m.syy += l.share * l.syy;
        m.ks += l.share * l.ks;
    }
    m.share = 1.0;
    return m;
}

OracleLobe momentsOf(const std::vector<OracleLobe>& lobes, float spread)
{
    shared::LobeMoments sum = shared::noMoments();
    OracleLobe m = meanOf(lobes);
    for (const OracleLobe& l : lobes)
        sum = shared::plusLobe(sum, float(l.share) * shared::lobeStrength(glm::vec3(float(l.ks))),
                               glm::vec2(l.nx, l.ny), glm::vec3(l.sxx, l.sxy, l.syy));
    const glm::vec2 n = shared::momentNormal(sum);
    const glm::vec3 s = shared::momentCovariance(sum, spread);
    return {n.x, n.y, s.x, s.y, s.z, m.ks, 1.0};
}

struct LookupErrors {
    double mean = 0.0, moments = 0.0;
};

double errorOf(const std::vector<OracleLobe>& truth, const OracleLobe& lobe)
{
    return oracleSums(truth, lobe, 200).relativeError(lobe.ks);
}

// Of the lobe midway between two neighbours of a row, against the average of both: an area of two texels.
LookupErrors twoTexels(const ReflectanceMips& mips, size_t level, int places)
{
    const Level& l = mips.levels[level];
    LookupErrors e;
    for (int i = 0; i < places; ++i) {
        const int x = i * 5 % (l.width - 1), y = i * 3 % l.height;
        const std::vector<OracleLobe> pair = {oracleLobe(l.at(x, y), 0.5), oracleLobe(l.at(x + 1, y), 0.5)};
        e.mean += errorOf(pair, meanOf(pair)) / places;
        e.moments += errorOf(pair, momentsOf(pair, 1.0f)) / places;
    }
    return e;
}

// The same against the level-0 lobes in an area of one texel around the place, which is what a pixel covers.
LookupErrors oneTexel(const ReflectanceMips& mips, size_t level, int places)
{
    const Level &l = mips.levels[level], &base = mips.levels[0];
    const int width = base.width / l.width;
    LookupErrors e;
    for (int i = 0; i < places; ++i) {
        const int x = i * 5 % (l.width - 1), y = i * 3 % l.height;
        const std::vector<OracleLobe> pair = {oracleLobe(l.at(x, y), 0.5), oracleLobe(l.at(x + 1, y), 0.5)};
        std::vector<OracleLobe> truth;
        for (int v = 0; v < width * width; ++v)
            truth.push_back(oracleLobe(base.at(x * width + width / 2 + v % width, y * width + v / width),
                                       1.0 / (width * width)));
        e.mean += errorOf(truth, meanOf(pair)) / places;
        e.moments += errorOf(truth, momentsOf(pair, 1.0f)) / places;
    }
    return e;
}

// A groove whose flanks are texels of their own: neighbours differ as much as they can.
ReflectanceMips flanks()
{
    Image normal(64, 64, 3);
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x) {
            const glm::vec3 n = glm::normalize(glm::vec3((x / 2) % 2 ? 0.25f : -0.25f, 0.0f, 1.0f));
            for (int c = 0; c < 3; ++c)
                normal.at(x, y)[c] = 0.5f + 0.5f * n[c];
        }
    return bake(normalMaps(std::move(normal), 200.0f), {});
}
} // namespace

TEST(LobeMoments, OfOneLobeAreThatLobe)
{
    const OracleLobe lobe{0.4, -0.3, 2e-3, 5e-4, 1e-3, 0.04, 1.0};
    const OracleLobe same = momentsOf({lobe}, 1.0f);
    EXPECT_NEAR(same.nx, lobe.nx, 1e-6);
    EXPECT_NEAR(same.ny, lobe.ny, 1e-6);
    EXPECT_NEAR(same.sxx, lobe.sxx, 1e-6);
    EXPECT_NEAR(same.sxy, lobe.sxy, 1e-6);
    EXPECT_NEAR(same.syy, lobe.syy, 1e-6);
}

TEST(LobeMoments, WeakLobesCountLess)
{
    const OracleLobe m =
        momentsOf({{0.2, 0.0, 0.01, 0.0, 0.01, 0.9, 0.5}, {-0.2, 0.0, 0.05, 0.0, 0.05, 0.1, 0.5}}, 1.0f);
    EXPECT_NEAR(m.nx, 0.16, 1e-4);
    EXPECT_NEAR(m.sxx, 0.9 * 0.01 + 0.1 * 0.05 + 0.9 * 0.1 * 0.4 * 0.4, 1e-4);
    EXPECT_NEAR(m.syy, 0.9 * 0.01 + 0.1 * 0.05, 1e-4);
    EXPECT_NEAR(m.ks, 0.5, 1e-6);
}

// Taps over a plane slope have the variance of the whole footprint.
TEST(LobeMoments, TapsVaryAsTheirFootprint)
{
    for (int n = 2; n <= 16; ++n) {
        std::vector<OracleLobe> taps;
        for (int i = 0; i < n; ++i)
            taps.push_back({0.3 * ((2.0 * i + 1.0) / n - 1.0), 0.0, 0.01, 0.0, 0.01, 1.0, 1.0 / n});
        EXPECT_NEAR(momentsOf(taps, shared::tapSpread(float(n))).sxx, 0.01 + 0.3 * 0.3 / 3.0, 1e-5) << n;
    }
}

TEST(LobeMoments, HoldTwoTexelsBetterThanMeansDo)
{
    const ReflectanceMips rough = bake(heightMaps(bumps(128, 128), 0.3f, 200.0f), {}), groove = flanks();
    for (const size_t level : {size_t(1), size_t(2)}) {
        const LookupErrors two = twoTexels(rough, level, 40), one = oneTexel(rough, level, 40);
        const std::string name = std::to_string(level);
        RecordProperty("two texels, means, level " + name, std::to_string(two.mean));
        RecordProperty("two texels, moments, level " + name, std::to_string(two.moments));
        RecordProperty("one texel, means, level " + name, std::to_string(one.mean));
        RecordProperty("one texel, moments, level " + name, std::to_string(one.moments));
        EXPECT_LT(two.moments, 0.6 * two.mean) << level;
        EXPECT_LT(one.mean, 1.05 * one.moments) << level; // why single taps take means
    }
    const LookupErrors flank = twoTexels(groove, 1, 20);
    RecordProperty("flanks, means", std::to_string(flank.mean));
    RecordProperty("flanks, moments", std::to_string(flank.moments));
    EXPECT_LT(flank.moments, 0.6 * flank.mean);
}
TEST(LobeMoments, ShapesAreAlikeWithinAThousandthOfTheirLeastWidth)
{
    const Shape brushed{0.1f, 0.2f, 1e-1f, 0.0f, 1e-4f}; // deviations 0.3 and 0.01
    EXPECT_TRUE(isAlike(brushed, brushed));
    Shape near = brushed, moved = brushed, wider = brushed;
    near.ny += 5e-6f;
    moved.nx += 1e-4f;
    wider.syy *= 1.01f;
    EXPECT_TRUE(isAlike(near, brushed));
    EXPECT_FALSE(isAlike(moved, brushed));
    EXPECT_FALSE(isAlike(wider, brushed));
}
} // namespace lumel::baker
