#include "core/compare.h"
#include "core/error.h"
#include <cmath>
#include <gtest/gtest.h>

using namespace lumel;

TEST(Compare, EqualPicturesHaveNoError)
{
    Image a(16, 8, 3);
    const Comparison result = compareImages(a, a);
    EXPECT_EQ(result.rmse, 0.0);
    EXPECT_TRUE(std::isinf(result.psnr));
    EXPECT_EQ(result.maxDifference, 0.0);
    EXPECT_EQ(result.yeeFailures, 0u);
}

TEST(Compare, RmseAndPsnrAreTheirDefinitions)
{
    Image a(10, 10, 3), b(10, 10, 3);
    for (float& v : b.pixels)
        v = 0.1f;
    EXPECT_NEAR(compareImages(a, b).rmse, 0.1, 1e-6);
    EXPECT_NEAR(compareImages(a, b).psnr, 20.0, 1e-4);
    b = a;
    b.at(3, 4)[1] = 0.6f;
    EXPECT_NEAR(compareImages(a, b).rmse, 0.6 / std::sqrt(300.0), 1e-6);
    EXPECT_NEAR(compareImages(a, b).maxDifference, 0.6, 1e-6);
}

TEST(Compare, DifferencesThatShowAreCounted)
{
    Image a(512, 256, 3), b(512, 256, 3);
    for (size_t i = 0; i < a.pixels.size(); ++i)
        a.pixels[i] = b.pixels[i] = 0.5f;
    for (int y = 60; y < 160; ++y)
        for (int x = 60; x < 160; ++x)
            b.at(x, y)[1] = b.at(x, y)[2] = 0.0f; // OpenImageIO's count is mostly one of colour
    EXPECT_GT(compareImages(a, b).yeeFailures, 100u);
}

TEST(Compare, DifferentSizesAreRefused)
{
    EXPECT_THROW(compareImages(Image(4, 4, 3), Image(4, 5, 3)), Error);
}
