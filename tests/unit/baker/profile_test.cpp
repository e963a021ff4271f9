// A profile tells where a bake's time goes and changes nothing.
#include "baker/bake.h"
#include "baker/profile.h"
#include "maps.h"
#include <chrono>
#include <gtest/gtest.h>
#include <numeric>

namespace lumel::baker {
namespace {

TEST(Profile, StepsAddUpToTheTimeOfOneThread)
{
    Options options;
    options.lobes = LobeCount::automatic;
    options.threads = 1;
    const Maps maps = test::heightMaps(test::bumps(64, 64), 0.1f, 200.0f);
    const ReflectanceMips plain = bake(maps, options);
    Profile profile;
    options.profile = &profile;
    const auto start = std::chrono::steady_clock::now();
    const ReflectanceMips timed = bake(maps, options);
    const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const auto seconds = profile.seconds();
    const double sum = std::accumulate(seconds.begin(), seconds.end(), 0.0);
    EXPECT_LE(sum, wall);
    EXPECT_GT(sum, 0.2 * wall);
    for (const Step step : {Step::sums, Step::searches, Step::secondLobes, Step::output})
        EXPECT_GT(seconds[size_t(step)], 0.0) << kStepNames[size_t(step)];
    EXPECT_EQ(plain.source, timed.source);
    for (size_t l = 0; l < plain.levels.size(); ++l)
        EXPECT_EQ(plain.levels[l].texels, timed.levels[l].texels);
}

} // namespace
} // namespace lumel::baker
