// Detail: a bound on lumels gives up the length of footprints first, then the size of lumels.
#include "tsl/detail.h"
#include <cmath>
#include <gtest/gtest.h>

namespace lumel::tsl {
namespace {

constexpr Detail kFinest{0.25f, 8.0f};

// All pixels' footprints are `longer` times longer than wide.
Elongations all(float longer, float pixels)
{
    Elongations elongations{};
    elongations[size_t(std::log2(longer) * float(shared::kElongationsPerOctave))] = pixels;
    return elongations;
}

TEST(Detail, PlentyLeavesItAtTheFinest)
{
    EXPECT_EQ(detailFor(all(6.0f, 100.0f), 100.0f, kFinest, 50.0f, std::nullopt), kFinest);
    EXPECT_EQ(detailFor({}, 0.0f, kFinest, 1.0f, std::nullopt), kFinest);
}

TEST(Detail, AnisotropyGoesBeforeTheSizeOfLumels)
{
    const Elongations steep = all(6.0f, 100.0f);
    float anisotropy = kFinest.anisotropy, offset = kFinest.levelOffset;
    for (float most = 20.0f; most > 0.05f; most *= 0.7f) {
        const Detail detail = detailFor(steep, 100.0f, kFinest, most, std::nullopt);
        EXPECT_LE(lumelsPerPixel(steep, 100.0f, detail), most * 1.001f);
        EXPECT_LE(detail.anisotropy, anisotropy);
        EXPECT_GE(detail.levelOffset, offset);
        if (detail.levelOffset > kFinest.levelOffset) {
            EXPECT_NEAR(detail.anisotropy, kLeastAnisotropy, 1e-4f);
        }
        if (detail != kFinest) { // no coarser than it must be
            EXPECT_GE(lumelsPerPixel(steep, 100.0f, detail), most * 0.99f);
        }
        anisotropy = detail.anisotropy;
        offset = detail.levelOffset;
    }
    EXPECT_GT(offset, 1.0f);
}

TEST(Detail, AnAnisotropyBelowTheLeastIsLeftAlone)
{
    const Detail detail = detailFor(all(6.0f, 100.0f), 100.0f, {0.0f, 1.0f}, 0.01f, std::nullopt);
    EXPECT_EQ(detail.anisotropy, 1.0f);
    EXPECT_GT(detail.levelOffset, 0.0f);
}

TEST(Detail, FollowsSlowlyAndIgnoresNoise)
{
    constexpr float kMost = 1.35f; // lumels a pixel
    const Elongations steep = all(6.0f, 100.0f);
    const Detail first = detailFor(steep, 100.0f, kFinest, kMost, std::nullopt);
    Elongations noisy = steep;
    for (float& pixels : noisy)
        pixels *= 1.1f;
    EXPECT_EQ(detailFor(noisy, 100.0f, kFinest, kMost, first), first);
    Detail detail = kFinest;
    for (int frame = 0; frame < 200; ++frame) {
        const Detail next = detailFor(steep, 100.0f, kFinest, kMost, detail);
        EXPECT_LT(std::abs(next.levelOffset - detail.levelOffset), 0.04f);
        EXPECT_LT(std::abs(std::log2(next.anisotropy / detail.anisotropy)), 0.04f);
        detail = next;
    }
    EXPECT_NEAR(detail.levelOffset, first.levelOffset, 0.2f);
    EXPECT_NEAR(detail.anisotropy, first.anisotropy, 0.2f);
}

} // namespace
} // namespace lumel::tsl
