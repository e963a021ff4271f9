#include "core/statistics.h"
#include <gtest/gtest.h>
#include <numeric>
#include <random>

namespace lumel {
namespace {

TEST(Percentile, IsTheNearestRank)
{
    std::vector<double> values(100);
    std::iota(values.rbegin(), values.rend(), 1.0); // 1 to 100, backwards
    EXPECT_EQ(percentile(values, 0.50), 50.0);
    EXPECT_EQ(percentile(values, 0.95), 95.0);
    EXPECT_EQ(percentile(values, 0.99), 99.0);
    EXPECT_EQ(percentile(values, 1.0), 100.0);
    EXPECT_EQ(percentile(values, 0.001), 1.0);
    EXPECT_EQ(percentile({3.0, 1.0, 2.0}, 0.5), 2.0);
    EXPECT_EQ(percentile({4.0, 1.0, 2.0, 3.0}, 0.5), 2.0);
    EXPECT_EQ(percentile({7.0}, 0.95), 7.0);
}

// Frame times of a path: a slow wave that both runs share, and noise of each one's own.
std::vector<double> frameTimes(size_t count, double factor, unsigned seed)
{
    std::mt19937 random(seed);
    std::normal_distribution<double> noise(1.0, 0.05);
    std::vector<double> ms;
    for (size_t i = 0; i < count; ++i)
        ms.push_back(factor * (20.0 + 8.0 * std::sin(0.02 * double(i))) * noise(random));
    return ms;
}

TEST(PercentileRatio, RangeHoldsTheTrueRatio)
{
    for (const double factor : {0.5, 1.0, 1.25})
        for (const double p : {0.5, 0.95}) {
            const Spread ratio = percentileRatio(frameTimes(600, 1.0, 1), frameTimes(600, factor, 2), p);
            EXPECT_LE(ratio.low, factor * 1.005);
            EXPECT_GE(ratio.high, factor * 0.995);
            EXPECT_LE(ratio.low, ratio.value);
            EXPECT_GE(ratio.high, ratio.value);
            EXPECT_LT(ratio.high - ratio.low, 0.15 * factor) << "the path's wave is common to both";
        }
}

TEST(PercentileRatio, ItselfIsOneWithoutSpread)
{
    const std::vector<double> ms = frameTimes(50, 1.0, 3);
    const Spread ratio = percentileRatio(ms, ms, 0.95);
    EXPECT_EQ(ratio.value, 1.0);
    EXPECT_EQ(ratio.low, 1.0);
    EXPECT_EQ(ratio.high, 1.0);
}

TEST(PercentileRatio, FewAndUnequallyManyValuesWork)
{
    const Spread ratio = percentileRatio({2.0}, frameTimes(37, 1.0, 4), 0.5);
    EXPECT_GT(ratio.low, 0.0);
    EXPECT_LE(ratio.low, ratio.high);
    EXPECT_EQ(percentileRatio({2.0}, {3.0}, 0.5).value, 1.5);
}

} // namespace
} // namespace lumel
