#include "tsl/texture_pool.h"
#include <algorithm>
#include <gtest/gtest.h>

using namespace lumel::tsl;

namespace {

size_t sumOfBytes(const TexturePool& pool)
{
    size_t bytes = 0;
    for (const PoolTexture& t : pool.textures())
        if (t.alive)
            bytes += poolTextureBytes(t.size);
    return bytes;
}

const size_t kBytes64 = poolTextureBytes({64, 64});

} // namespace

TEST(TexturePool, CountsTheFullMipChain)
{
    EXPECT_EQ(poolTextureBytes({1, 1}), 8u);
    EXPECT_EQ(poolTextureBytes({4, 4}), (16u + 4u + 1u) * 8u);
    EXPECT_EQ(poolTextureBytes({4, 1}), (4u + 2u + 1u) * 8u);
}

TEST(TexturePool, AnObjectKeepsItsTextureWhileItsSizeStays)
{
    TexturePool pool(10 * kBytes64);
    const int first = *pool.acquire(7, {64, 64}, 1);
    const int again = *pool.acquire(7, {64, 64}, 2);
    EXPECT_EQ(again, first);
    EXPECT_EQ(pool.usedBytes(), kBytes64);
}

TEST(TexturePool, TheLeastRecentlyUsedIsTakenOverFirst)
{
    TexturePool pool(3 * kBytes64);
    const int a = *pool.acquire(0, {64, 64}, 1);
    const int b = *pool.acquire(1, {64, 64}, 2);
    const int c = *pool.acquire(2, {64, 64}, 3);
    EXPECT_EQ(*pool.acquire(0, {64, 64}, 4), a); // refreshed
    EXPECT_EQ(*pool.acquire(3, {64, 64}, 5), b);
    EXPECT_EQ(*pool.acquire(4, {64, 64}, 6), c);
    EXPECT_EQ(pool.usedBytes(), 3 * kBytes64);
}

TEST(TexturePool, WhatThisFrameUsesIsNeverTakenAway)
{
    TexturePool pool(2 * kBytes64);
    ASSERT_TRUE(pool.acquire(0, {64, 64}, 1));
    ASSERT_TRUE(pool.acquire(1, {64, 64}, 1));
    EXPECT_FALSE(pool.acquire(2, {64, 64}, 1));
    EXPECT_FALSE(pool.acquire(3, {32, 32}, 1));
    EXPECT_TRUE(pool.acquire(2, {64, 64}, 2));
}

TEST(TexturePool, OtherClassesGiveUpMemoryWhenTheCapBinds)
{
    TexturePool pool(poolTextureBytes({128, 128}));
    for (int i = 0; i < 4; ++i)
        ASSERT_TRUE(pool.acquire(i, {64, 64}, 1));
    ASSERT_TRUE(pool.acquire(9, {128, 128}, 2));
    EXPECT_LE(pool.usedBytes(), pool.capBytes());
    EXPECT_EQ(pool.usedBytes(), sumOfBytes(pool));
}

TEST(TexturePool, NeverPassesTheCapOverManyFrames)
{
    TexturePool pool(20 * kBytes64);
    uint32_t random = 1;
    for (uint64_t frame = 1; frame < 500; ++frame) {
        std::vector<int> owned;
        for (int object = 0; object < 30; ++object) {
            random = random * 1664525u + 1013904223u;
            if (random >> 30 != 0)
                continue;
            const uint32_t side = 8u << ((random >> 8) % 5);
            if (const auto texture = pool.acquire(object, {side, side}, frame))
                owned.push_back(*texture);
            ASSERT_LE(pool.usedBytes(), pool.capBytes());
            ASSERT_EQ(pool.usedBytes(), sumOfBytes(pool));
        }
        std::sort(owned.begin(), owned.end()); // no texture drawn by two objects of one frame
        ASSERT_EQ(std::adjacent_find(owned.begin(), owned.end()), owned.end());
    }
}
