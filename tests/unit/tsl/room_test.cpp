#include "tsl/room.h"
#include <gtest/gtest.h>

using namespace lumel::tsl;

TEST(Room, LightsTheFinerOfTheTwoBlendedLevels)
{
    EXPECT_EQ(litLevelFor(0.0f, 0, {1024, 1024}), 0u);
    EXPECT_EQ(litLevelFor(2.99f, 0, {1024, 1024}), 2u);
    EXPECT_EQ(litLevelFor(3.0f, 0, {1024, 1024}), 3u);
    EXPECT_EQ(litLevelFor(3.0f, 2, {1024, 1024}), 5u);
    EXPECT_EQ(litLevelFor(29.0f, 0, {1024, 256}), 10u); // the 1 x 1 level
}

TEST(Room, OnlyVisibleLightableObjectsGetTextures)
{
    TexturePool pool(size_t(64) << 20);
    const std::vector<ObjectNeed> needs = {
        {.visible = true, .lightable = true, .level = 1.5f, .litSize = {512, 512}},
        {.visible = false, .lightable = true, .level = 0.0f, .litSize = {512, 512}},
        {.visible = true, .lightable = false, .level = 0.0f, .litSize = {512, 512}},
    };
    const Room room = assignRoom(pool, needs, 1);
    EXPECT_GE(room.objects[0].texture, 0);
    EXPECT_EQ(room.objects[0].litLevel, 1u);
    EXPECT_EQ(pool.textures()[size_t(room.objects[0].texture)].size, glm::uvec2(256));
    EXPECT_EQ(room.objects[1].texture, -1);
    EXPECT_EQ(room.objects[2].texture, -1);
}

TEST(Room, WhenTheCapBindsEverythingGetsCoarserTogetherAndNothingFails)
{
    TexturePool pool(size_t(4) << 20);
    const std::vector<ObjectNeed> needs(
        500, {.visible = true, .lightable = true, .level = 0.2f, .litSize = {512, 512}});
    const Room room = assignRoom(pool, needs, 1);
    EXPECT_GT(room.levelBias, 0u);
    for (const ObjectRoom& object : room.objects) {
        EXPECT_GE(object.texture, 0);
        EXPECT_EQ(object.litLevel, room.levelBias);
    }
    EXPECT_LE(pool.usedBytes(), pool.capBytes());
}

TEST(Room, QualityReturnsWhenTheLoadFalls)
{
    TexturePool pool(size_t(4) << 20);
    std::vector<ObjectNeed> needs(500,
                                  {.visible = true, .lightable = true, .level = 0.0f, .litSize = {512, 512}});
    EXPECT_GT(assignRoom(pool, needs, 1).levelBias, 0u);
    needs.resize(1);
    const Room room = assignRoom(pool, needs, 2);
    EXPECT_EQ(room.levelBias, 0u);
    EXPECT_EQ(room.objects[0].litLevel, 0u);
}
