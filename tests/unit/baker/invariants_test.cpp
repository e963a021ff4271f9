// No method is better than the fit, whatever the map: E(Ashikhmin-Shirley fit) <= E(Blinn-Phong fit) <= E of
// every closed form with the Ks of least error. A Blinn-Phong lobe stands against the closed forms that
// are isotropic too; an anisotropic one (LEAN's, or any over anisotropic lobes) may be better than it.
#include "maps.h"
#include "oracle.h"
#include <fmt/format.h>
#include <mutex>
#include <tbb/parallel_for.h>

namespace lumel::baker {
namespace {
using namespace test;

constexpr double kTolerance = 3e-4; // of errors that the baker states: its quadrature, and a search's end

// Random bumps of random power, size and kind; of every third map each texel has a power of its own, of
// every third a strength.
Maps randomMap(unsigned seed, int size)
{
    std::mt19937 random(seed);
    const auto uniform = [&](float a, float b) { return a + (b - a) * float(random() % 10000) / 10000.0f; };
    const float slope = std::exp(uniform(-2.5f, 0.7f)), power = std::exp(uniform(0.5f, 6.0f));
    Maps maps;
    if (seed % 2 == 0) {
        Image heights(size, size, 1);
        for (float& h : heights.pixels)
            h = uniform(0.0f, 1.0f);
        maps = heightMaps(std::move(heights), 2.0f * slope / float(size), power);
    } else {
        maps = normalMaps(noiseNormals(size, size, slope, seed), power);
    }
    if (seed % 3 != 0) {
        maps.power = Image(size, size, 1);
        for (float& p : maps.power.pixels)
            p = std::exp(uniform(0.0f, 6.5f));
    }
    if (seed % 3 != 1) {
        maps.specular = Image(size, size, 1);
        for (float& ks : maps.specular.pixels)
            ks = std::pow(uniform(0.0f, 1.0f), 4.0f);
    }
    if (seed % 5 == 4)
        maps.anisotropicPower = {std::exp(uniform(0.0f, 5.5f)), std::exp(uniform(0.0f, 5.5f))};
    return maps;
}

struct Chains {
    ReflectanceMips as, bp;
    std::vector<ReflectanceMips> forms;
};

Chains chainsOf(const Maps& maps, float precision)
{
    const auto baked = [&](Method method, Model model) {
        Options options;
        options.method = method;
        options.model = model;
        options.bestKs = true;
        options.precision = precision;
        return bake(maps, options);
    };
    Chains chains{baked(Method::fit, Model::ashikhminShirley), baked(Method::fit, Model::blinnPhong), {}};
    for (const Method method : {Method::average, Method::toksvig, Method::lean, Method::flat, Method::height})
        if (method != Method::height || !maps.height.empty())
            chains.forms.push_back(baked(method, Model::ashikhminShirley));
    return chains;
}

bool isIsotropic(const float* texel)
{
    return std::abs(texel[kSxx] - texel[kSyy]) < 1e-6f * texel[kSxx] &&
           std::abs(texel[kSxy]) < 1e-6f * texel[kSxx];
}

// The orders that do not hold at texel i of a level, by an error for each texel of a chain.
template<class ErrorOf>
std::string violations(const Chains& chains, double tolerance, size_t level, size_t i, const ErrorOf& errorOf)
{
    std::string text;
    const auto at = [&](const ReflectanceMips& mips) {
        return mips.levels[level].texels.data() + i * kChannels;
    };
    const auto expectOrder = [&](double less, double more, const std::string& what) {
        if (less > more + tolerance)
            text += fmt::format("level {} texel {}: {}: {:.6f} > {:.6f}\n", level, i, what, less, more);
    };
    const double as = errorOf(at(chains.as)), bp = errorOf(at(chains.bp));
    expectOrder(as, bp, "AS above BP");
    for (const ReflectanceMips& form : chains.forms) {
        const double error = errorOf(at(form));
        expectOrder(as, error, "AS above " + form.method);
        if (isIsotropic(at(form)))
            expectOrder(bp, error, "BP above " + form.method);
    }
    return text;
}

void expectStatedOrder(const Maps& maps, const std::string& name)
{
    for (const float precision : {0.0f, Options().precision}) {
        const Chains chains = chainsOf(maps, precision);
        std::string text;
        for (size_t l = 1; l < chains.as.levels.size(); ++l)
            for (size_t i = 0; i < chains.as.levels[l].texels.size() / kChannels; ++i)
                text += violations(chains, kTolerance + double(precision), l, i,
                                   [](const float* texel) { return double(texel[kError]); });
        EXPECT_EQ(text, "") << name << ", precision " << precision;
    }
}

// Errors and best Ks summed by the oracle over a dense grid.
void expectBruteForceOrder(const Maps& maps, float precision, const std::string& name)
{
    constexpr int kCells = 128; // per side: half a deviation of the narrowest lobe apart
    const Chains chains = chainsOf(maps, precision);
    std::string text;
    std::mutex mutex;
    for (size_t l = 1; l < chains.as.levels.size(); ++l) {
        const int width = chains.as.levels[l].width;
        tbb::parallel_for(0, width * width, [&](int i) {
            const auto lobes = lobesUnder(chains.as, l, i % width, i / width);
            const std::string found =
                violations(chains, kTolerance + double(precision), l, size_t(i), [&](const float* texel) {
                    return oracleSums(lobes, oracleLobe(texel), kCells).bestError();
                });
            std::lock_guard lock(mutex);
            text += found;
        });
    }
    EXPECT_EQ(text, "") << name << ", precision " << precision;
}
} // namespace

TEST(Invariants, HoldOverRandomMaps)
{
    for (unsigned seed = 0; seed < 60; ++seed)
        expectStatedOrder(randomMap(seed, 32), "seed " + std::to_string(seed));
}

// The same by brute force.
TEST(Invariants, HoldByBruteForce)
{
    for (const unsigned seed : {1u, 4u, 8u, 11u}) {
        Maps maps = randomMap(seed, 8);
        for (float& power : maps.power.pixels)
            power = std::min(power, 250.0f);
        maps.powerConstant = std::min(maps.powerConstant, 250.0f);
        maps.anisotropicPower = glm::min(maps.anisotropicPower, glm::vec2(250.0f));
        for (const float precision : {0.0f, Options().precision})
            expectBruteForceOrder(maps, precision, "seed " + std::to_string(seed));
    }
}

TEST(Invariants, HoldOverBumps)
{
    expectStatedOrder(heightMaps(bumps(64, 64), 0.2f, 150.0f), "bumps");
    expectStatedOrder(heightMaps(bumps(64, 64), 0.2f, 3.0f), "broad lobes");
}

TEST(Invariants, HoldOnWallsNearTheHorizon)
{
    for (const float power : {3.0f, 30.0f, 200.0f})
        expectStatedOrder(heightMaps(bumps(64, 64), 1.0f, power), "walls, power " + std::to_string(power));
    for (const float power : {3.0f, 100.0f})
        expectStatedOrder(normalMaps(noiseNormals(64, 64, 2.0f, 3), power),
                          "noise, power " + std::to_string(power));
}

TEST(Invariants, HoldOverLongLobes)
{
    for (const float scale : {0.2f, 1.0f}) {
        Maps maps = heightMaps(bumps(64, 64), scale, 1.0f);
        maps.anisotropicPower = {100.0f, 5.0f};
        expectStatedOrder(maps, "long lobes");
    }
    Maps turned = normalMaps(noiseNormals(64, 64, 0.5f, 3), 1.0f);
    turned.anisotropicPower = {5.0f, 100.0f};
    turned.tangentRotation = bumps(64, 64);
    expectStatedOrder(turned, "turned long lobes");
}

// The best Ks of closed forms: no other Ks gives less error.
TEST(Invariants, BestKsIsTheProjection)
{
    const Maps maps = randomMap(8, 8);
    Options options;
    options.method = Method::lean;
    const ReflectanceMips own = bake(maps, options);
    options.bestKs = true;
    const ReflectanceMips best = bake(maps, options);
    EXPECT_NE(own.source, best.source);
    for (size_t l = 1; l < best.levels.size(); ++l) {
        const float *t = best.levels[l].at(0, 0), *mean = own.levels[l].at(0, 0);
        const OracleSums sums = oracleSums(lobesUnder(best, l, 0, 0), oracleLobe(t), 300);
        EXPECT_NEAR(t[kKsR], sums.gf / sums.ff, 3e-3 * t[kKsR]);
        EXPECT_NEAR(t[kError], sums.bestError(), 2e-3);
        EXPECT_LE(t[kError], mean[kError] + 1e-5f);
        EXPECT_NEAR(mean[kError], sums.relativeError(mean[kKsR]), 2e-3 * (1.0 + mean[kError]));
        for (int c = kNx; c <= kSyy; ++c)
            EXPECT_EQ(t[c], mean[c]);
    }
}
} // namespace lumel::baker
