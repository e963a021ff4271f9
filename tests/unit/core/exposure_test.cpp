// Automatic exposure from histograms whose answer is known.
#include "core/exposure.h"
#include <cmath>
#include <gtest/gtest.h>
#include <random>

using namespace lumel;

namespace {

LuminanceHistogram histogramOf(const std::vector<float>& luminances)
{
    LuminanceHistogram histogram{};
    for (const float luminance : luminances)
        ++histogram[shared::meterBin(luminance)];
    return histogram;
}

TEST(Exposure, BinsAreEighthsOfOctaves)
{
    EXPECT_EQ(shared::meterBin(0.0f), 0u);
    EXPECT_EQ(shared::meterBin(-1.0f), 0u);
    EXPECT_EQ(shared::meterBin(std::nanf("")), 0u);
    EXPECT_EQ(shared::meterBin(std::exp2(-20.0f)), 0u);
    EXPECT_EQ(shared::meterBin(1.0f), 128u);
    EXPECT_EQ(shared::meterBin(1.124f), 128u);
    EXPECT_EQ(shared::meterBin(1.125f), 129u);
    EXPECT_EQ(shared::meterBin(2.0f), 136u);
    EXPECT_EQ(shared::meterBin(1e9f), 255u);
}

TEST(Exposure, TheKeyIsTheLogAverageOfTheUpperHalfWithoutHighlights)
{
    std::mt19937 random(5);
    std::lognormal_distribution<float> distribution(2.0f, 1.5f);
    std::vector<float> luminances(20000);
    for (float& luminance : luminances)
        luminance = distribution(random);
    const LuminanceHistogram histogram = histogramOf(luminances);
    std::sort(luminances.begin(), luminances.end());
    double sum = 0.0;
    for (size_t i = 10000; i < 19000; ++i)
        sum += std::log2(double(luminances[i])) / 9000.0;
    EXPECT_NEAR(std::log2(*keyLuminance(histogram)), sum, 0.02);
    EXPECT_NEAR(std::log2(*luminancePercentile(histogram, 0.25)), std::log2(luminances[5000]), 0.13);
}

TEST(Exposure, GreyComesOutMiddleGreyAtAnyLightLevel)
{
    for (float luminance = 1e-4f; luminance < 6e4f; luminance *= 3.0f) {
        const float exposure = automaticExposure(histogramOf(std::vector<float>(100, luminance)));
        EXPECT_NEAR(std::log2(luminance * exposure), std::log2(0.18), 0.13)
            << luminance; // half a step, half a bin
        char text[32];    // the printed number is the number
        std::snprintf(text, sizeof text, "%.3g", double(exposure));
        EXPECT_EQ(std::strtof(text, nullptr), exposure);
    }
}

TEST(Exposure, BlackPixelsAndFewBrightOnesDoNotCount)
{
    std::vector<float> luminances(1000, 0.5f);
    const float exposure = automaticExposure(histogramOf(luminances));
    luminances.insert(luminances.end(), 5000, 0.0f);
    EXPECT_EQ(automaticExposure(histogramOf(luminances)), exposure);
    luminances.insert(luminances.end(), 40, 5e4f);
    EXPECT_EQ(automaticExposure(histogramOf(luminances)), exposure);
    EXPECT_EQ(automaticExposure(LuminanceHistogram{}), 1.0f);
    EXPECT_EQ(automaticExposure(histogramOf(std::vector<float>(9, 0.0f))), 1.0f);
}

TEST(Exposure, IsNeededWhereThePictureWouldBeWhiteOrBlack)
{
    const auto needed = [](std::vector<float> luminances) { return needsExposure(histogramOf(luminances)); };
    EXPECT_FALSE(needed({0.02f, 0.1f, 0.3f, 0.8f, 4.0f}));
    EXPECT_TRUE(needed({0.5f, 2.0f, 3.0f, 300.0f, 400.0f}));
    EXPECT_TRUE(needed({0.001f, 0.002f, 0.003f, 0.0f, 0.015f}));
    EXPECT_FALSE(needed({0.0f, 0.0f, 0.0f, 0.0f, 0.5f})); // something to be seen
    EXPECT_FALSE(needed({}));                             // nothing to be done
}

TEST(Exposure, AdaptsAndArrivesExactly)
{
    ExposureAdaptation eye;
    eye.aim(2.0f);
    EXPECT_EQ(eye.advance(0.02), 2.0f); // the first is there at once
    eye.aim(0.011f);
    float before = 2.0f;
    int frames = 0;
    for (; !eye.arrived() && frames < 1000; ++frames) {
        const float now = eye.advance(0.02);
        EXPECT_LT(now, before);
        EXPECT_GE(now, 0.011f * 0.999f);
        if (frames == 24) { // half a second: 63 % of the way in stops
            EXPECT_NEAR(std::log2(now), std::log2(2.0f) + 0.632 * std::log2(0.011f / 2.0f), 0.05);
        }
        before = now;
    }
    EXPECT_LT(frames, 200); // 4 s for 7.5 stops
    EXPECT_EQ(before, 0.011f);
    eye.aim(0.012f); // an eighth of a stop
    EXPECT_TRUE(eye.arrived());
    EXPECT_EQ(eye.advance(1.0), 0.011f);
}

} // namespace
