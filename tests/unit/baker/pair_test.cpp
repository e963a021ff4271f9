// Two lobes a texel: the search, and what it finds, by independent means.
#include "baker/fit_kernel.h"
#include "maps.h"
#include "oracle.h"
#include <numeric>

namespace lumel::baker {
namespace {
using namespace test;

constexpr LobeCount kCounts[] = {LobeCount::automatic, LobeCount::two};

Options withLobes(LobeCount lobes, float precision = 0.002f)
{
    Options options;
    options.precision = precision;
    options.lobes = lobes;
    return options;
}

// Lobes as a 2 x 2 map: normals (x, y) on the disc, of one power.
Maps quad(const std::vector<glm::vec2>& normals, float power)
{
    Image image(2, 2, 3);
    for (size_t i = 0; i < 4; ++i) {
        const glm::vec2 n = normals[i];
        const float values[] = {n.x, n.y, std::sqrt(1.0f - n.x * n.x - n.y * n.y)};
        for (size_t c = 0; c < 3; ++c)
            image.pixels[i * 3 + c] = 0.5f * values[c] + 0.5f;
    }
    return normalMaps(std::move(image), power);
}

OracleLobe secondLobe(const float* s)
{
    return {s[kN2x], s[kN2y], s[kS2xx], s[kS2xy], s[kS2yy], s[kKs2R], 1.0};
}

// E of both lobes of a texel as they are stored, by brute force.
double pairError(const ReflectanceMips& mips, size_t level, int x, int y, int cells = 300)
{
    const std::vector<OracleLobe> under = lobesUnder(mips, level, x, y);
    std::vector<OracleLobe> fit = {oracleLobe(mips.levels[level].at(x, y))};
    if (!mips.levels[level].second.empty())
        fit.push_back(secondLobe(mips.levels[level].secondAt(x, y)));
    return oracleError(under, fit, cells);
}

// V-grooves along y of this period in texels, slopes +-0.25.
Maps grooveMaps(int size, int period, float power)
{
    Image image(size, size, 3);
    for (int i = 0; i < size * size; ++i) {
        const glm::vec3 n = glm::normalize(glm::vec3(i % period < period / 2 ? 0.25f : -0.25f, 0.0f, 1.0f));
        for (int c = 0; c < 3; ++c)
            image.pixels[size_t(i) * 3 + size_t(c)] = 0.5f * n[c] + 0.5f;
    }
    return normalMaps(std::move(image), power);
}

Maps varyingMaps(int size)
{
    Maps maps = normalMaps(noiseNormals(size, size, 0.2f, 5), 100.0f);
    maps.power = bumps(size, size);
    for (float& power : maps.power.pixels)
        power = 20.0f + 300.0f * power;
    return maps;
}

size_t countSeconds(const Level& level)
{
    size_t count = 0;
    for (size_t i = kKs2G; i < level.second.size(); i += kSecondChannels)
        count += level.second[i] > 0.0f;
    return count;
}

template<class Check>
void forTexels(const ReflectanceMips& mips, const Check& check)
{
    for (size_t l = 1; l < mips.levels.size(); ++l)
        for (int y = 0; y < mips.levels[l].height; ++y)
            for (int x = 0; x < mips.levels[l].width; ++x)
                check(l, x, y);
}
} // namespace

TEST(Pairs, StatedErrorsAreThoseOfBruteForce)
{
    const Maps all[] = {normalMaps(noiseNormals(16, 16, 0.25f, 3), 60.0f),
                        heightMaps(bumps(16, 16), 0.2f, 100.0f), varyingMaps(16)};
    for (const Maps& maps : all)
        for (const float precision : {0.0f, 0.002f}) {
            const ReflectanceMips mips = bake(maps, withLobes(LobeCount::two, precision));
            EXPECT_GT(countSeconds(mips.levels[1]), 10u);
            forTexels(mips, [&](size_t l, int x, int y) {
                const double stated = mips.levels[l].at(x, y)[kError];
                EXPECT_NEAR(pairError(mips, l, x, y), stated, 2e-3 + double(precision))
                    << "level " << l << " at " << x << ", " << y << ", precision " << precision;
            });
        }
}

TEST(Pairs, AreNeverWorseThanOneLobe)
{
    for (const Maps& maps : {normalMaps(noiseNormals(64, 64, 0.25f, 3), 60.0f),
                             heightMaps(bumps(64, 64), 0.3f, 150.0f), varyingMaps(64)}) {
        const ReflectanceMips one = bake(maps, {});
        for (const LobeCount lobes : kCounts) {
            const ReflectanceMips two = bake(maps, withLobes(lobes));
            EXPECT_NE(two.source, one.source);
            forTexels(two, [&](size_t l, int x, int y) {
                const float single = one.levels[l].at(x, y)[kError], both = two.levels[l].at(x, y)[kError];
                const bool hasSecond = two.levels[l].secondAt(x, y)[kKs2G] > 0.0f;
                if (!hasSecond) // it is the chain of one lobe
                    EXPECT_TRUE(std::equal(one.levels[l].at(x, y), one.levels[l].at(x, y) + kChannels,
                                           two.levels[l].at(x, y)));
                else if (lobes == LobeCount::automatic)
                    EXPECT_LE(both, std::min(0.75f * single, single - 0.005f));
                else
                    EXPECT_LT(both, single);
            });
        }
    }
}

TEST(Pairs, ReproduceGrooves)
{
    for (const float power : {50.0f, 200.0f, 1000.0f}) {
        const ReflectanceMips mips = bake(grooveMaps(32, 8, power), withLobes(LobeCount::automatic));
        for (size_t l = 3; l < mips.levels.size(); ++l) {
            const Level& level = mips.levels[l];
            EXPECT_EQ(countSeconds(level), size_t(level.width) * size_t(level.height)) << "power " << power;
            EXPECT_LT(meanOf(level, kError), 0.002) << "power " << power << " level " << l;
            // Neighbours agree which flank is the first lobe's.
            for (int i = 0; i < level.width * level.height; ++i)
                EXPECT_GT(level.at(i % level.width, i / level.width)[kNx] * level.at(0, 0)[kNx], 0.0f);
        }
    }
}

TEST(Pairs, FindTwoLobesThatAreThere)
{
    const ReflectanceMips mips =
        bake(quad({{0.2f, 0.1f}, {-0.3f, 0.0f}, {-0.3f, 0.0f}, {-0.3f, 0.0f}}, 100.0f),
             withLobes(LobeCount::automatic));
    const float *t = mips.levels[1].at(0, 0), *s = mips.levels[1].secondAt(0, 0);
    EXPECT_LT(t[kError], 1e-3f);
    EXPECT_NEAR(t[kNx], -0.3f, 2e-3f); // the stronger one first
    EXPECT_NEAR(s[kN2x], 0.2f, 2e-3f);
    EXPECT_NEAR(s[kN2y], 0.1f, 2e-3f);
    EXPECT_NEAR(s[kKs2R] / t[kKsR], 1.0f / 3.0f, 0.01f);
    const float alone = mips.levels[0].at(0, 0)[kKsR]; // each lobe keeps its energy
    EXPECT_NEAR(t[kKsR] + s[kKs2R], alone, 0.01f * alone);
}

// No pair of lobes on a grid of normals and powers is better than an isotropic fit.
TEST(Pairs, NothingOnAGridIsBetter)
{
    const Maps maps = quad({{0.25f, 0.0f}, {0.1f, 0.0f}, {-0.05f, 0.0f}, {-0.3f, 0.0f}}, 60.0f);
    Options options = withLobes(LobeCount::two, 0.0f);
    options.model = Model::blinnPhong;
    const ReflectanceMips mips = bake(maps, options);
    const std::vector<OracleLobe> under = lobesUnder(mips, 1, 0, 0);
    std::vector<OracleLobe> grid;
    for (float x = -0.4f; x < 0.4f; x += 0.05f)
        for (const float power : {15.0f, 22.0f, 32.0f, 45.0f, 60.0f})
            grid.push_back({x, 0.0, 1.0 / power, 0.0, 1.0 / power, 1.0, 1.0});
    const double best = bestPairError(under, grid, 160);
    EXPECT_LE(pairError(mips, 1, 0, 0), best + 1e-4);
    EXPECT_GT(pairError(mips, 1, 0, 0), 0.5 * best); // the grid is no strawman
}

TEST(Pairs, DoNotDependOnTheOrderOfLobes)
{
    std::vector<glm::vec2> normals = {{0.25f, 0.05f}, {0.1f, -0.2f}, {-0.05f, 0.15f}, {-0.3f, 0.0f}};
    const ReflectanceMips first = bake(quad(normals, 80.0f), withLobes(LobeCount::two));
    const float error = first.levels[1].at(0, 0)[kError];
    EXPECT_GT(first.levels[1].secondAt(0, 0)[kKs2G], 0.0f);
    std::vector<size_t> order = {0, 1, 2, 3};
    while (std::next_permutation(order.begin(), order.end())) {
        std::vector<glm::vec2> permuted;
        for (const size_t i : order)
            permuted.push_back(normals[i]);
        const ReflectanceMips mips = bake(quad(permuted, 80.0f), withLobes(LobeCount::two));
        EXPECT_NEAR(mips.levels[1].at(0, 0)[kError], error, 1e-3f);
    }
}

TEST(Pairs, TurnWithTheMap)
{
    const std::vector<glm::vec2> normals = {{0.25f, 0.05f}, {0.1f, -0.2f}, {-0.05f, 0.15f}, {-0.3f, 0.0f}};
    const float error = bake(quad(normals, 80.0f), withLobes(LobeCount::two)).levels[1].at(0, 0)[kError];
    for (float angle = 0.3f; angle < 6.3f; angle += 0.3f) {
        std::vector<glm::vec2> turned;
        for (const glm::vec2 n : normals)
            turned.push_back({std::cos(angle) * n.x - std::sin(angle) * n.y,
                              std::sin(angle) * n.x + std::cos(angle) * n.y});
        const ReflectanceMips mips = bake(quad(turned, 80.0f), withLobes(LobeCount::two));
        EXPECT_NEAR(mips.levels[1].at(0, 0)[kError], error, 2e-3f) << "angle " << angle;
    }
}

TEST(Pairs, DoNotDependOnThreads)
{
    for (const Maps& maps : {heightMaps(bumps(128, 96), 0.3f, 150.0f), varyingMaps(96)}) {
        Options options = withLobes(LobeCount::automatic);
        options.threads = 1;
        const ReflectanceMips one = bake(maps, options);
        for (const int threads : {2, 5}) {
            options.threads = threads;
            const ReflectanceMips more = bake(maps, options);
            for (size_t l = 0; l < one.levels.size(); ++l) {
                EXPECT_EQ(one.levels[l].texels, more.levels[l].texels) << threads << " threads, level " << l;
                EXPECT_EQ(one.levels[l].second, more.levels[l].second) << threads << " threads, level " << l;
            }
        }
    }
}

// Where two lobes serve well, they reflect what the average does.
TEST(Pairs, KeepEnergy)
{
    const ReflectanceMips mips =
        bake(normalMaps(noiseNormals(32, 32, 0.15f, 9), 100.0f), withLobes(LobeCount::two));
    int checked = 0;
    forTexels(mips, [&](size_t l, int x, int y) {
        const float *t = mips.levels[l].at(x, y), *s = mips.levels[l].secondAt(x, y);
        if (t[kError] > 0.005f || s[kKs2G] <= 0.0f || checked > 100)
            return;
        const std::vector<OracleLobe> under = lobesUnder(mips, l, x, y);
        const OracleSums first = oracleSums(under, oracleLobe(t), 160),
                         second = oracleSums(under, secondLobe(s), 160);
        EXPECT_NEAR((t[kKsR] * first.f + s[kKs2R] * second.f) / first.g, 1.0, 0.04);
        ++checked;
    });
    EXPECT_GT(checked, 20);
}

// Each lobe may have a colour of its own; grey stays grey.
TEST(Pairs, ColoursFollowTheLobesWhereTheyDiffer)
{
    Maps maps = quad({{0.3f, 0.0f}, {-0.3f, 0.0f}, {0.3f, 0.0f}, {-0.3f, 0.0f}}, 100.0f);
    maps.specular = Image(2, 2, 3);
    for (int i = 0; i < 4; ++i)
        for (int c = 0; c < 3; ++c)
            maps.specular.pixels[size_t(i * 3 + c)] = (i % 2 == 0) == (c == 0) ? 0.9f : 0.1f;
    for (const float precision : {0.0f, 0.002f}) {
        const ReflectanceMips mips = bake(maps, withLobes(LobeCount::automatic, precision));
        const float *t = mips.levels[1].at(0, 0), *s = mips.levels[1].secondAt(0, 0);
        const float* red = t[kNx] > 0.0f ? t : s; // both begin alike
        const float* blue = red == t ? s : t;
        ASSERT_GT(s[kKs2B], 0.0f);
        EXPECT_NEAR(red[kKsR] / red[kKsB], 9.0f, 0.3f);
        EXPECT_NEAR(blue[kKsB] / blue[kKsR], 9.0f, 0.3f);
    }
    const Maps grey = quad({{0.3f, 0.0f}, {-0.3f, 0.0f}, {0.2f, 0.1f}, {-0.3f, 0.0f}}, 100.0f);
    const ReflectanceMips mips = bake(grey, withLobes(LobeCount::automatic));
    EXPECT_FLOAT_EQ(mips.levels[1].secondAt(0, 0)[kKs2R], mips.levels[1].secondAt(0, 0)[kKs2B]);
}

TEST(Pairs, BlackAndUniformMapsAndReducedChainsHaveTheirBounds)
{
    Maps black = normalMaps(noiseNormals(16, 16, 0.3f, 2), 80.0f);
    black.specularConstant = glm::vec3(0.0f);
    Maps uniform = normalMaps(constantImage(16, 16, {0.6f, 0.5f, 0.9f}), 80.0f);
    for (const Maps& maps : {black, uniform})
        for (const Level& level : bake(maps, withLobes(LobeCount::two)).levels)
            EXPECT_TRUE(level.second.empty());
    Options reduced = withLobes(LobeCount::automatic);
    reduced.reduce = 1;
    const ReflectanceMips mips = bake(normalMaps(noiseNormals(16, 16, 0.3f, 2), 80.0f), reduced);
    EXPECT_TRUE(mips.levels[0].second.empty());
    EXPECT_GT(countSeconds(mips.levels[1]), 0u);
    Options form = withLobes(LobeCount::two);
    form.method = Method::lean;
    EXPECT_TRUE(bake(normalMaps(noiseNormals(16, 16, 0.3f, 2), 80.0f), form).levels[1].second.empty());
}

// The diffuse term is along the lobes' mean normal, whichever comes first.
TEST(Pairs, DiffuseIsAlongTheMeanNormal)
{
    Maps maps = grooveMaps(16, 8, 200.0f);
    maps.diffuseConstant = glm::vec3(0.5f);
    const ReflectanceMips mips = bake(maps, withLobes(LobeCount::automatic));
    const float* t = mips.levels[3].at(0, 0);
    ASSERT_GT(countSeconds(mips.levels[3]), 0u);
    EXPECT_NEAR(t[kKdR], 0.5f / std::sqrt(1.0f + 0.25f * 0.25f), 2e-3f);
}
} // namespace lumel::baker
