#include "tsl/room.h"
#include <gtest/gtest.h>

using namespace lumel::tsl;

namespace {

ObjectNeed need(float level, glm::uvec2 litSize)
{
    return {.inView = true,
            .visible = true,
            .lightable = true,
            .level = level,
            .samples = 100,
            .litSize = litSize};
}

glm::uvec2 sizeOf(const TexturePool& pool, const ObjectRoom& room)
{
    return pool.blocks()[size_t(room.texture.block)].size;
}

} // namespace

TEST(Room, LightsTheFinerOfTheTwoBlendedLevels)
{
    EXPECT_EQ(litLevelFor(0.0f, {1024, 1024}), 0u);
    EXPECT_EQ(litLevelFor(-3.0f, {1024, 1024}), 0u);
    EXPECT_EQ(litLevelFor(2.99f, {1024, 1024}), 2u);
    EXPECT_EQ(litLevelFor(3.0f, {1024, 1024}), 3u);
    EXPECT_EQ(litLevelFor(29.0f, {1024, 256}), 7u); // one tile
}

TEST(Room, OnlyVisibleLightableObjectsGetTextures)
{
    TexturePool pool(size_t(64) << 20);
    std::vector<ObjectNeed> needs(3, need(1.5f, {512, 512}));
    needs[1].visible = false;
    needs[2].lightable = false;
    Rooms rooms;
    rooms.assign(pool, needs, 1);
    ASSERT_TRUE(rooms.objects()[0].texture);
    EXPECT_EQ(rooms.objects()[0].litLevel, 1u);
    EXPECT_EQ(sizeOf(pool, rooms.objects()[0]), glm::uvec2(256));
    EXPECT_FALSE(rooms.objects()[1].texture);
    EXPECT_FALSE(rooms.objects()[2].texture);
}

TEST(Room, AnObjectThatNoSampleMetKeepsItsTexture)
{
    TexturePool pool(size_t(64) << 20);
    std::vector<ObjectNeed> needs{need(1.5f, {512, 512})};
    Rooms rooms;
    rooms.assign(pool, needs, 1);
    const TextureId texture = rooms.objects()[0].texture;
    needs[0].visible = false;
    rooms.assign(pool, needs, 2);
    EXPECT_EQ(rooms.objects()[0].texture, texture);
    EXPECT_FALSE(rooms.objects()[0].fresh);
}

TEST(Room, WhenTheCapBindsEverythingGetsCoarserTogetherAndNothingFails)
{
    TexturePool pool(size_t(4) << 20);
    const std::vector<ObjectNeed> needs(500, need(0.2f, {512, 512}));
    Rooms rooms;
    rooms.assign(pool, needs, 1);
    EXPECT_GT(rooms.levelBias(), 0.0f);
    for (const ObjectRoom& object : rooms.objects()) {
        EXPECT_TRUE(object.texture);
        EXPECT_EQ(object.litLevel, rooms.objects()[0].litLevel);
    }
    EXPECT_LE(pool.usedBytes(), pool.capBytes());
}

TEST(Room, QualityReturnsWhenTheLoadFalls)
{
    TexturePool pool(size_t(4) << 20);
    std::vector<ObjectNeed> needs(500, need(0.0f, {512, 512}));
    Rooms rooms;
    rooms.assign(pool, needs, 1);
    EXPECT_GT(rooms.levelBias(), 0.0f);
    for (size_t i = 1; i < needs.size(); ++i)
        needs[i].inView = needs[i].visible = false;
    rooms.assign(pool, needs, 2);
    rooms.assign(pool, needs, 3);
    EXPECT_EQ(rooms.levelBias(), 0.0f);
    EXPECT_EQ(rooms.objects()[0].litLevel, 0u);
}

TEST(Room, AFinerTextureTakesOverWhatWasLitAndFadesIn)
{
    TexturePool pool(size_t(64) << 20);
    Rooms rooms;
    rooms.assign(pool, std::vector{need(2.1f, {512, 512})}, 1);
    const TextureId coarse = rooms.objects()[0].texture;
    rooms.assign(pool, std::vector{need(1.9f, {512, 512})}, 2);
    const ObjectRoom& room = rooms.objects()[0];
    EXPECT_TRUE(room.fresh);
    EXPECT_EQ(room.previous, coarse);
    EXPECT_EQ(room.litLevel, 1u);
    EXPECT_EQ(room.finest, 1.0f); // the coarse texture's MIP 0
    for (uint64_t frame = 3; !rooms.steady(); ++frame) {
        const float before = room.finest;
        rooms.assign(pool, std::vector{need(1.9f, {512, 512})}, frame);
        EXPECT_LT(room.finest, before);
        ASSERT_LT(frame, 20u);
    }
    EXPECT_EQ(room.finest, 0.0f);
}

TEST(Room, ATextureInItsPredecessorsMemoryIsFresh)
{
    TexturePool pool(TextureLayout({512, 512}).blockBytes()); // for either texture, not for both
    Rooms rooms;
    rooms.assign(pool, std::vector{need(1.5f, {512, 512})}, 1);
    EXPECT_EQ(rooms.objects()[0].litLevel, 1u);
    rooms.assign(pool, std::vector{need(0.5f, {512, 512})}, 2);
    EXPECT_EQ(rooms.objects()[0].litLevel, 0u);
    EXPECT_TRUE(rooms.objects()[0].fresh);
    EXPECT_FALSE(rooms.objects()[0].previous);
}

TEST(Room, ACoarserTextureThatDoesNotFitBesideTheLitOneWaits)
{
    TexturePool pool(TextureLayout({512, 512}).blockBytes());
    Rooms rooms;
    rooms.assign(pool, std::vector{need(0.5f, {512, 512})}, 1);
    const TextureId lit = rooms.objects()[0].texture;
    rooms.assign(pool, std::vector{need(1.5f, {512, 512})}, 2);
    EXPECT_EQ(rooms.objects()[0].texture, lit);
    EXPECT_EQ(rooms.objects()[0].litLevel, 0u);
    EXPECT_FALSE(rooms.objects()[0].fresh);
}

TEST(Room, ALevelThatWaversAroundAWholeOneChangesNothing)
{
    TexturePool pool(size_t(64) << 20);
    Rooms rooms;
    rooms.assign(pool, std::vector{need(1.95f, {512, 512})}, 1);
    for (uint64_t frame = 2; frame < 20; ++frame) {
        rooms.assign(pool, std::vector{need(frame % 2 ? 1.95f : 2.05f, {512, 512})}, frame);
        EXPECT_FALSE(rooms.objects()[0].fresh);
        EXPECT_EQ(rooms.objects()[0].litLevel, 1u);
    }
}

TEST(Room, TinyObjectsLeaveTextureSpaceWithoutAJumpAndReturnLater)
{
    TexturePool pool(size_t(64) << 20);
    Rooms rooms;
    const auto across = [](float lumels) { return need(std::log2(512.0f / lumels), {512, 512}); };
    rooms.assign(pool, std::vector{across(20.0f)}, 1);
    EXPECT_EQ(rooms.objects()[0].share, 1.0f);
    float before = 1.0f;
    uint64_t frame = 2;
    for (; rooms.objects()[0].share > 0.0f; ++frame) {
        rooms.assign(pool, std::vector{across(5.0f)}, frame);
        EXPECT_LE(before - rooms.objects()[0].share, 0.13f);
        before = rooms.objects()[0].share;
        ASSERT_LT(frame, 20u);
    }
    EXPECT_FALSE(rooms.objects()[0].texture);
    rooms.assign(pool, std::vector{across(0.5f * (kLeave + kReturn))}, ++frame); // hysteresis
    EXPECT_EQ(rooms.objects()[0].share, 0.0f);
    rooms.assign(pool, std::vector{across(20.0f)}, ++frame);
    EXPECT_GT(rooms.objects()[0].share, 0.0f);
    EXPECT_LT(rooms.objects()[0].share, 0.2f);
}

TEST(Rooms, ObjectsLeaveBeforeTheirChartsRunIntoEachOther)
{
    TexturePool pool(size_t(64) << 20);
    Rooms rooms;
    const auto at = [](float level) {
        ObjectNeed n = need(level, {1024, 1024});
        n.coarsest = 2.0f;
        return std::vector{n};
    };
    rooms.assign(pool, at(2.0f + kLeaveLevel - 0.05f), 1);
    EXPECT_EQ(rooms.objects()[0].share, 1.0f);
    uint64_t frame = 2;
    for (; rooms.objects()[0].share > 0.0f && frame < 30; ++frame) // fades
        rooms.assign(pool, at(2.0f + kLeaveLevel + 0.05f), frame);
    EXPECT_FALSE(rooms.objects()[0].texture);
    EXPECT_GT(frame, 6u);
    rooms.assign(pool, at(2.0f + 0.5f * (kLeaveLevel + kReturnLevel)), ++frame); // hysteresis
    EXPECT_EQ(rooms.objects()[0].share, 0.0f);
    rooms.assign(pool, at(2.0f), ++frame);
    EXPECT_GT(rooms.objects()[0].share, 0.0f);
}
