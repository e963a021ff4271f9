// Fitting for bilinear reconstruction.
#include "baker/lookup.h"
#include "baker/tent.h"
#include "maps.h"

namespace lumel::baker {
namespace {
using namespace test;

Options bilinear()
{
    Options options;
    options.reconstruction = Reconstruction::bilinear;
    return options;
}
} // namespace

TEST(Reconstruction, TentSharesSumToOneAtAnySize)
{
    std::vector<TentShare> shares;
    for (const Wrap wrap : {Wrap::repeat, Wrap::clamp})
        for (const int size : {1, 2, 3, 7, 16, 37})
            for (int coarse = 1; coarse <= size; ++coarse)
                for (int x = 0; x < coarse; ++x) {
                    tentShares(
                        x, coarse, size, wrap, size, [](int i) { return double(i); },
                        [](double at) { return int(std::floor(at + 1e-7)); }, shares);
                    double sum = 0.0;
                    for (const TentShare& s : shares) {
                        sum += double(s.share);
                        if (wrap == Wrap::clamp)
                            ASSERT_TRUE(s.cell >= 0 && s.cell < size);
                        else
                            ASSERT_TRUE(s.cell >= -size && s.cell < 2 * size);
                    }
                    ASSERT_NEAR(sum, 1.0, 1e-5) << x << " of " << coarse << " over " << size;
                }
}

// Two texels per flank of the tent: 1/8, 3/8, 3/8, 1/8 of a row, whatever path a level takes.
TEST(Reconstruction, LevelsAverageUnderTheTent)
{
    const int n = 64;
    Maps maps = normalMaps(constantImage(n, 1, {0.5f, 0.5f, 1.0f}), 50.0f);
    maps.diffuse = Image(n, 1, 1);
    std::mt19937 random(3);
    for (float& v : maps.diffuse.pixels)
        v = float(random() % 100) / 100.0f;
    const ReflectanceMips mips = bake(maps, bilinear());
    for (size_t l = 1; l < mips.levels.size() - 1; ++l)
        for (int x = 0; x < mips.levels[l].width; ++x) {
            const double scale = double(1 << l), centre = (x + 0.5) * scale;
            // Coarse levels resolve the tent to half a texel.
            const int cell = l >= 3 ? 1 << (l - 1) : 1;
            double expected = 0.0;
            for (int i = -n; i < 2 * n; ++i) {
                const double from = std::floor(double(i) / cell) * cell, to = from + cell;
                const double share =
                    (tentMass((to - centre) / scale) - tentMass((from - centre) / scale)) / cell;
                expected += share * double(maps.diffuse.pixels[size_t((i + n) % n)]);
            }
            EXPECT_NEAR(mips.levels[l].at(x, 0)[kKdR], expected, 1e-4) << "level " << l << " texel " << x;
        }
}

TEST(Reconstruction, BilinearFitsServeBilinearLookupsBetter)
{
    const Maps maps = heightMaps(bumps(128, 128), 0.06f, 100.0f);
    const ReflectanceMips box = bake(maps, {}), tent = bake(maps, bilinear());
    EXPECT_NE(box.source, tent.source);
    for (size_t l = 3; l <= 4; ++l) {
        const double boxError = lookupError(maps, box, l, 150), tentError = lookupError(maps, tent, l, 150);
        RecordProperty("box" + std::to_string(l), std::to_string(boxError));
        RecordProperty("bilinear" + std::to_string(l), std::to_string(tentError));
        EXPECT_LT(tentError, 1.3 * boxError) << "level " << l;
    }
}

TEST(Reconstruction, FlatMapsAndOddSizesSurvive)
{
    for (const Wrap wrap : {Wrap::repeat, Wrap::clamp}) {
        Maps maps = normalMaps(noiseNormals(37, 21, 0.2f, 3), 60.0f);
        maps.wrap = wrap;
        for (const Level& level : bake(maps, bilinear()).levels)
            for (const float v : level.texels)
                ASSERT_TRUE(std::isfinite(v));
    }
    const ReflectanceMips flat =
        bake(normalMaps(constantImage(24, 40, {0.6f, 0.4f, 0.9f}), 70.0f), bilinear());
    EXPECT_EQ(flat.levels.back().at(0, 0)[kNx], flat.levels[0].at(0, 0)[kNx]);
    EXPECT_EQ(flat.levels.back().at(0, 0)[kError], 0.0f);
}
} // namespace lumel::baker
