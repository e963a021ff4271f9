// What the inspector shows of a texel is what the baker says of it.
#include "baker/inspect.h"
#include "maps.h"
#include <algorithm>

namespace lumel::baker {
namespace {
using namespace test;

Maps smallMap()
{
    return heightMaps(bumps(16, 16), 0.1f, 90.0f);
}
} // namespace

TEST(Inspect, ErrorsAreTheBakers)
{
    const Maps maps = smallMap();
    const std::vector<Level> fit = bake(maps, {}).levels;
    const std::vector<Level> lean = bake(maps, {.method = Method::lean, .bestKs = true}).levels;
    const TexelInspector inspector(maps);
    for (size_t level = 1; level < fit.size(); ++level) {
        const TexelLobes lobes = inspector.look(fit, level, 0, 0, fit[level].at(0, 0));
        EXPECT_NEAR(lobes.fit.error, fit[level].at(0, 0)[kError], 2e-3) << level;
        EXPECT_NEAR(lobes.lean.error, lean[level].at(0, 0)[kError], 2e-3) << level;
    }
}

TEST(Inspect, SecondLobesCount)
{
    const Maps maps = heightMaps(bumps(16, 16), 0.4f, 90.0f);
    const std::vector<Level> fit = bake(maps, {.lobes = LobeCount::two}).levels;
    const TexelInspector inspector(maps);
    for (size_t level = 1; level < 4; ++level) {
        ASSERT_FALSE(fit[level].second.empty());
        const TexelLobes lobes =
            inspector.look(fit, level, 0, 0, fit[level].at(0, 0), fit[level].secondAt(0, 0));
        EXPECT_NEAR(lobes.fit.error, fit[level].at(0, 0)[kError], 3e-3) << level;
    }
}

TEST(Inspect, PicturesShowTheAverageUpToItsPeak)
{
    const Maps maps = smallMap();
    const std::vector<Level> fit = bake(maps, {}).levels;
    const TexelLobes lobes = TexelInspector(maps).look(fit, 2, 1, 3, fit[2].at(1, 3));
    for (const DiscPicture* picture : {&lobes.average, &lobes.fit, &lobes.lean})
        EXPECT_EQ(picture->values.size(), size_t(lobes.side) * size_t(lobes.side));
    const float most = *std::max_element(lobes.average.values.begin(), lobes.average.values.end());
    EXPECT_LE(most, 1.0001f * float(lobes.peak));
    EXPECT_GE(most, 0.8f * float(lobes.peak));
}

} // namespace lumel::baker
