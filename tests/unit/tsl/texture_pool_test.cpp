#include "tsl/texture_pool.h"
#include <gtest/gtest.h>
#include <set>

using namespace lumel::tsl;

namespace {

size_t sumOfBytes(const TexturePool& pool)
{
    size_t bytes = 0;
    for (const PoolBlock& block : pool.blocks())
        if (!block.textures.empty())
            bytes += block.bytes();
    return bytes;
}

// A class with one texture per block, so that bytes count textures.
constexpr glm::uvec2 kBig(512);
const size_t kBigBytes = TextureLayout(kBig).layerBytes();

} // namespace

TEST(TextureLayout, MipsLieBesideEachOtherWithoutOverlap)
{
    for (const glm::uvec2 size :
         {glm::uvec2(8), glm::uvec2(64, 16), glm::uvec2(16, 64), glm::uvec2(256, 1)}) {
        const TextureLayout layout(size);
        std::set<std::pair<uint32_t, uint32_t>> taken;
        uint32_t tiles = 0;
        for (uint32_t mip = 0; mip < layout.mips; ++mip) {
            const glm::uvec2 origin = lumel::shared::mipOrigin(size, mip);
            const glm::uvec2 lumels = glm::max(size >> mip, glm::uvec2(1));
            EXPECT_EQ(layout.tileOffsets[mip], tiles);
            tiles += (lumels.x + 7) / 8 * ((lumels.y + 7) / 8);
            for (uint32_t y = 0; y < lumels.y; ++y)
                for (uint32_t x = 0; x < lumels.x; ++x) {
                    ASSERT_TRUE(taken.emplace(origin.x + x, origin.y + y).second) << "MIP " << mip;
                    ASSERT_LT(origin.x + x, layout.extent.x);
                    ASSERT_LT(origin.y + y, layout.extent.y);
                }
        }
        EXPECT_EQ(layout.tiles, tiles);
        EXPECT_EQ(glm::max(size >> (layout.mips - 1), glm::uvec2(1)), glm::uvec2(1));
    }
}

TEST(TexturePool, AnObjectKeepsItsTextureWhileItsSizeStays)
{
    TexturePool pool(10 * kBigBytes);
    const TextureId first = pool.acquire(7, 0, kBig, 1);
    EXPECT_EQ(pool.acquire(7, 0, kBig, 2), first);
    EXPECT_EQ(pool.usedBytes(), kBigBytes);
    EXPECT_EQ(pool.latestOf(7), first);
}

TEST(TexturePool, SmallTexturesShareABlock)
{
    TexturePool pool(size_t(8) << 20);
    const TextureId a = pool.acquire(0, 0, {32, 32}, 1);
    const TextureId b = pool.acquire(1, 0, {32, 32}, 1);
    EXPECT_EQ(a.block, b.block);
    EXPECT_NE(a.layer, b.layer);
    EXPECT_EQ(pool.usedBytes(), sumOfBytes(pool));
}

TEST(TexturePool, ManyTexturesShareFewBlocksAndLittleIsLeftOver)
{
    for (const uint32_t side : {64u, 128u, 256u}) {
        const size_t bytes = TextureLayout(glm::uvec2(side)).layerBytes();
        TexturePool pool(size_t(512) << 20);
        for (int object = 0; object < 100; ++object)
            ASSERT_TRUE(pool.acquire(object, 0, glm::uvec2(side), 1));
        EXPECT_LE(pool.blocks().size(), 8u) << side;
        EXPECT_LE(pool.usedBytes(), 200 * bytes) << side;
        TexturePool tight(100 * bytes); // no room is wasted where there is none
        for (int object = 0; object < 100; ++object)
            ASSERT_TRUE(tight.acquire(object, 0, glm::uvec2(side), 1)) << side << " " << object;
    }
}

TEST(TexturePool, TheLeastRecentlyUsedIsTakenOverFirst)
{
    TexturePool pool(3 * kBigBytes);
    const TextureId a = pool.acquire(0, 0, kBig, 1);
    const TextureId b = pool.acquire(1, 0, kBig, 2);
    const TextureId c = pool.acquire(2, 0, kBig, 3);
    EXPECT_EQ(pool.acquire(0, 0, kBig, 4), a); // refreshed
    EXPECT_EQ(pool.acquire(3, 0, kBig, 5), b);
    EXPECT_EQ(pool.acquire(4, 0, kBig, 6), c);
    EXPECT_EQ(pool.usedBytes(), 3 * kBigBytes);
    EXPECT_FALSE(pool.latestOf(1));
}

TEST(TexturePool, WhatThisFrameUsesIsNeverTakenAway)
{
    TexturePool pool(2 * kBigBytes);
    ASSERT_TRUE(pool.acquire(0, 0, kBig, 1));
    ASSERT_TRUE(pool.acquire(1, 0, kBig, 1));
    EXPECT_FALSE(pool.acquire(2, 0, kBig, 1));
    EXPECT_FALSE(pool.acquire(3, 0, {32, 32}, 1));
    EXPECT_TRUE(pool.acquire(2, 0, kBig, 2));
}

TEST(TexturePool, OtherClassesGiveUpMemoryWhenTheCapBinds)
{
    TexturePool pool(TextureLayout({1024, 1024}).layerBytes());
    for (int i = 0; i < 3; ++i)
        ASSERT_TRUE(pool.acquire(i, 0, kBig, 1));
    ASSERT_TRUE(pool.acquire(9, 0, {1024, 1024}, 2));
    EXPECT_LE(pool.usedBytes(), pool.capBytes());
    EXPECT_EQ(pool.usedBytes(), sumOfBytes(pool));
    EXPECT_FALSE(pool.latestOf(0));
}

TEST(TexturePool, LeavesRoomWhileTexturesOutOfViewCanMakeIt)
{
    TexturePool pool(4 * kBigBytes);
    pool.leaveFree(2 * kBigBytes);
    for (int i = 0; i < 3; ++i)
        ASSERT_TRUE(pool.acquire(i, 0, kBig, uint64_t(i)));
    EXPECT_EQ(pool.usedBytes(), 2 * kBigBytes);
    EXPECT_FALSE(pool.latestOf(0)); // the one least recently used
    // What one frame draws comes first.
    for (int i = 0; i < 4; ++i)
        ASSERT_TRUE(pool.acquire(i, 0, kBig, 9));
    EXPECT_EQ(pool.usedBytes(), 4 * kBigBytes);
}

TEST(TexturePool, NeverPassesTheCapOverManyFrames)
{
    TexturePool pool(20 * kBigBytes);
    uint32_t random = 1;
    for (uint64_t frame = 1; frame < 500; ++frame) {
        std::set<std::pair<int, uint32_t>> owned;
        for (int object = 0; object < 60; ++object) {
            random = random * 1664525u + 1013904223u;
            if (random >> 30 != 0)
                continue;
            const uint32_t side = 32u << ((random >> 8) % 6);
            if (const TextureId texture = pool.acquire(object, 0, {side, side}, frame)) {
                // No texture drawn by two objects of one frame.
                ASSERT_TRUE(owned.emplace(texture.block, texture.layer).second);
                ASSERT_EQ(pool.texture(texture).owner, object);
            }
            ASSERT_LE(pool.usedBytes(), pool.capBytes());
            ASSERT_EQ(pool.usedBytes(), sumOfBytes(pool));
        }
    }
}
