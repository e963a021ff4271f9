// What the talk observed of fitted reflectance MIPs, measured here.
#include "maps.h"
#include "oracle.h"

namespace lumel::baker {
namespace {
using namespace test;

double meanPower(const Level& level)
{
    double sum = 0.0;
    for (size_t i = 0; i < level.texels.size(); i += kChannels) {
        const float* t = &level.texels[i];
        sum += 1.0 / std::sqrt(double(t[kSxx]) * t[kSyy] - double(t[kSxy]) * t[kSxy]);
    }
    return sum / double(level.texels.size() / kChannels);
}

Options blinnPhong()
{
    Options options;
    options.model = Model::blinnPhong;
    return options;
}

// Octaves of random sines, each twice as fine and `gain` times as high: rough at every scale.
Image fractal(int size, float gain)
{
    std::mt19937 random(12);
    std::uniform_real_distribution<float> uniform(0.0f, 6.2831853f);
    Image image(size, size, 1);
    float height = 1.0f;
    for (int waves = 2; waves <= size / 4; waves *= 2, height *= gain)
        for (int k = 0; k < 4; ++k) {
            const float angle = uniform(random), phase = uniform(random);
            const float wx = std::round(float(waves) * std::cos(angle)),
                        wy = std::round(float(waves) * std::sin(angle));
            for (int y = 0; y < size; ++y)
                for (int x = 0; x < size; ++x)
                    *image.at(x, y) +=
                        height * std::sin(6.2831853f * (wx * float(x) + wy * float(y)) / float(size) + phase);
        }
    return image;
}
} // namespace

// "32-power texels over rough bumps give a next level near 5": for bumps of the matching roughness.
TEST(Talk, ThirtyTwoPowerOverRoughBumpsGivesAboutFive)
{
    const ReflectanceMips rough = bake(normalMaps(noiseNormals(64, 64, 0.5f, 31), 32.0f), blinnPhong());
    EXPECT_GT(meanPower(rough.levels[2]), 3.0);
    EXPECT_LT(meanPower(rough.levels[2]), 8.0);
    const ReflectanceMips smooth = bake(normalMaps(noiseNormals(64, 64, 0.05f, 31), 32.0f), blinnPhong());
    EXPECT_GT(meanPower(smooth.levels[2]), 25.0);
}

TEST(Talk, RoughSurfacesKeepHalfToSeventyPercentOfThePowerPerLevel)
{
    const ReflectanceMips mips = bake(heightMaps(fractal(128, 0.52f), 0.012f, 200.0f), blinnPhong());
    for (size_t l = 1; l <= 4; ++l) {
        const double kept = meanPower(mips.levels[l]) / meanPower(mips.levels[l - 1]);
        RecordProperty("kept" + std::to_string(l), std::to_string(kept));
        EXPECT_GT(kept, 0.4) << "level " << l;
        EXPECT_LT(kept, 0.85) << "level " << l;
    }
}

TEST(Talk, BestNormalLiesCloseToTheAverage)
{
    const Maps maps = heightMaps(bumps(128, 128), 0.1f, 100.0f);
    Options average;
    average.method = Method::average;
    const ReflectanceMips fit = bake(maps, blinnPhong()), mean = bake(maps, average);
    for (size_t l = 1; l <= 4; ++l) {
        double angle = 0.0;
        const size_t count = fit.levels[l].texels.size() / kChannels;
        for (size_t i = 0; i < count; ++i) {
            const float *a = &fit.levels[l].texels[i * kChannels], *b = &mean.levels[l].texels[i * kChannels];
            angle += std::hypot(a[kNx] - b[kNx], a[kNy] - b[kNy]);
        }
        angle *= 180.0 / M_PI / double(count);
        RecordProperty("degrees" + std::to_string(l), std::to_string(angle));
        EXPECT_LT(angle, 6.0) << "level " << l;
    }
}

// At every power that lobes may have: bumps whose slopes are of a lobe's width, so that fits widen it and
// stay good. Energy is the integral over the disc; Ks is the projection, which need not keep it.
void expectEnergyKept(const Options& options, double tolerance)
{
    for (const float power : {1.0f, 2.0f, 5.0f, 20.0f, 60.0f, 200.0f, 1000.0f, 3000.0f, 10000.0f}) {
        const float deviation = 1.0f / std::sqrt(power);
        const ReflectanceMips mips =
            bake(heightMaps(bumps(64, 64), 0.15f * std::min(deviation, 0.3f), power), options);
        const int cells = std::max(160, int(4.0f / deviation)); // half a deviation apart
        int checked = 0;
        double worst = 0.0;
        for (size_t l = 1; l <= 3; ++l)
            for (int i = 0; i < mips.levels[l].width; i += 5) {
                const float* t = mips.levels[l].at(i, i);
                if (t[kError] > 0.002f)
                    continue;
                const OracleSums sums = oracleSums(lobesUnder(mips, l, i, i), oracleLobe(t), cells);
                const double kept = t[kKsR] * sums.f / sums.g;
                EXPECT_NEAR(kept, 1.0, tolerance) << "power " << power << " level " << l << " texel " << i;
                worst = std::max(worst, std::abs(kept - 1.0));
                ++checked;
            }
        EXPECT_GT(checked, 5) << "power " << power;
        ::testing::Test::RecordProperty("worst at power " + std::to_string(int(power)),
                                        std::to_string(worst));
    }
}

TEST(Talk, WellFittedTexelsKeepTheirEnergy)
{
    expectEnergyKept(exactly(), 0.01);
}

// An error of 0.002, the default precision, is an amplitude of 0.045.
TEST(Talk, TexelsThatNeedNoSearchKeepTheirEnergy)
{
    expectEnergyKept({}, 0.025);
}

// "You can get away with minimising just P and Ks": the normal is the average's, and the error between the
// full fit's and that of the mean lobe.
TEST(Talk, CheapModeKeepsTheAverageNormal)
{
    Maps glossy = normalMaps(noiseNormals(32, 32, 0.2f, 5), 100.0f);
    glossy.power = bumps(32, 32);
    for (float& power : glossy.power.pixels)
        power = 20.0f + 200.0f * power;
    for (const Maps& maps : {normalMaps(noiseNormals(32, 32, 0.2f, 5), 100.0f), glossy}) {
        const auto baked = [&](Method method) {
            Options options;
            options.method = method;
            options.bestKs = true;
            return bake(maps, options);
        };
        const ReflectanceMips cheap = baked(Method::fitPower), mean = baked(Method::average),
                              fit = baked(Method::fit);
        for (size_t l = 1; l < cheap.levels.size(); ++l) {
            for (size_t i = 0; i < cheap.levels[l].texels.size(); i += kChannels)
                for (const int c : {kNx, kNy})
                    ASSERT_NEAR(cheap.levels[l].texels[i + size_t(c)], mean.levels[l].texels[i + size_t(c)],
                                1e-5f);
            EXPECT_LE(meanOf(cheap.levels[l], kError), meanOf(mean.levels[l], kError) + 1e-3);
            EXPECT_GE(meanOf(cheap.levels[l], kError), meanOf(fit.levels[l], kError) - 3e-3);
        }
    }
}
} // namespace lumel::baker
