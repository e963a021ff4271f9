#include "tsl/residency.h"
#include <gtest/gtest.h>

using namespace lumel::tsl;

namespace {

ObjectFeedback feedbackAt(float level, glm::uvec2 litSize)
{
    return {.inView = true,
            .visible = true,
            .lightable = true,
            .level = level,
            .samples = 100,
            .litSize = litSize};
}

glm::uvec2 sizeOf(const TexturePool& pool, const ObjectResidency& resident)
{
    return pool.blocks()[size_t(resident.texture.block)].size;
}

} // namespace

TEST(Residency, LightsTheFinerOfTheTwoBlendedLevels)
{
    EXPECT_EQ(litLevelFor(0.0f, {1024, 1024}), 0u);
    EXPECT_EQ(litLevelFor(-3.0f, {1024, 1024}), 0u);
    EXPECT_EQ(litLevelFor(2.99f, {1024, 1024}), 2u);
    EXPECT_EQ(litLevelFor(3.0f, {1024, 1024}), 3u);
    EXPECT_EQ(litLevelFor(29.0f, {1024, 256}), 7u); // one tile
}

TEST(Residency, OnlyVisibleLightableObjectsGetTextures)
{
    TexturePool pool(size_t(64) << 20);
    std::vector<ObjectFeedback> feedback(3, feedbackAt(1.5f, {512, 512}));
    feedback[1].visible = false;
    feedback[2].lightable = false;
    Residency residency;
    residency.assign(pool, feedback, 1);
    ASSERT_TRUE(residency.objects()[0].texture);
    EXPECT_EQ(residency.objects()[0].litLevel, 1u);
    EXPECT_EQ(sizeOf(pool, residency.objects()[0]), glm::uvec2(256));
    EXPECT_FALSE(residency.objects()[1].texture);
    EXPECT_FALSE(residency.objects()[2].texture);
}

TEST(Residency, AnObjectThatNoSampleMetKeepsItsTexture)
{
    TexturePool pool(size_t(64) << 20);
    std::vector<ObjectFeedback> feedback{feedbackAt(1.5f, {512, 512})};
    Residency residency;
    residency.assign(pool, feedback, 1);
    const TextureId texture = residency.objects()[0].texture;
    feedback[0].visible = false;
    residency.assign(pool, feedback, 2);
    EXPECT_EQ(residency.objects()[0].texture, texture);
    EXPECT_FALSE(residency.objects()[0].fresh);
}

TEST(Residency, WhenTheCapBindsEverythingGetsCoarserTogetherAndNothingFails)
{
    TexturePool pool(size_t(4) << 20);
    const std::vector<ObjectFeedback> feedback(500, feedbackAt(0.2f, {512, 512}));
    Residency residency;
    residency.assign(pool, feedback, 1);
    EXPECT_GT(residency.levelBias(), 0.0f);
    for (const ObjectResidency& object : residency.objects()) {
        EXPECT_TRUE(object.texture);
        EXPECT_EQ(object.litLevel, residency.objects()[0].litLevel);
    }
    EXPECT_LE(pool.usedBytes(), pool.capBytes());
}

TEST(Residency, QualityReturnsWhenTheLoadFalls)
{
    TexturePool pool(size_t(4) << 20);
    std::vector<ObjectFeedback> feedback(500, feedbackAt(0.0f, {512, 512}));
    Residency residency;
    residency.assign(pool, feedback, 1);
    EXPECT_GT(residency.levelBias(), 0.0f);
    for (size_t i = 1; i < feedback.size(); ++i)
        feedback[i].inView = feedback[i].visible = false;
    residency.assign(pool, feedback, 2);
    residency.assign(pool, feedback, 3);
    EXPECT_EQ(residency.levelBias(), 0.0f);
    EXPECT_EQ(residency.objects()[0].litLevel, 0u);
}

TEST(Residency, AFinerTextureTakesOverWhatWasLitAndFadesIn)
{
    TexturePool pool(size_t(64) << 20);
    Residency residency;
    residency.assign(pool, std::vector{feedbackAt(2.1f, {512, 512})}, 1);
    const TextureId coarse = residency.objects()[0].texture;
    residency.assign(pool, std::vector{feedbackAt(1.9f, {512, 512})}, 2);
    const ObjectResidency& resident = residency.objects()[0];
    EXPECT_TRUE(resident.fresh);
    EXPECT_EQ(resident.previous, coarse);
    EXPECT_EQ(resident.litLevel, 1u);
    EXPECT_EQ(resident.finest, 1.0f); // the coarse texture's MIP 0
    for (uint64_t frame = 3; !residency.steady(); ++frame) {
        const float before = resident.finest;
        residency.assign(pool, std::vector{feedbackAt(1.9f, {512, 512})}, frame);
        EXPECT_LT(resident.finest, before);
        ASSERT_LT(frame, 20u);
    }
    EXPECT_EQ(resident.finest, 0.0f);
}

TEST(Residency, ATextureInItsPredecessorsMemoryIsFresh)
{
    TexturePool pool(TextureLayout({512, 512}).layerBytes()); // for either texture, not for both
    Residency residency;
    residency.assign(pool, std::vector{feedbackAt(1.5f, {512, 512})}, 1);
    EXPECT_EQ(residency.objects()[0].litLevel, 1u);
    residency.assign(pool, std::vector{feedbackAt(0.5f, {512, 512})}, 2);
    EXPECT_EQ(residency.objects()[0].litLevel, 0u);
    EXPECT_TRUE(residency.objects()[0].fresh);
    EXPECT_FALSE(residency.objects()[0].previous);
}

TEST(Residency, ACoarserTextureThatDoesNotFitBesideTheLitOneWaits)
{
    TexturePool pool(TextureLayout({512, 512}).layerBytes());
    Residency residency;
    residency.assign(pool, std::vector{feedbackAt(0.5f, {512, 512})}, 1);
    const TextureId lit = residency.objects()[0].texture;
    residency.assign(pool, std::vector{feedbackAt(1.5f, {512, 512})}, 2);
    EXPECT_EQ(residency.objects()[0].texture, lit);
    EXPECT_EQ(residency.objects()[0].litLevel, 0u);
    EXPECT_FALSE(residency.objects()[0].fresh);
}

TEST(Residency, ALevelThatWaversAroundAWholeOneChangesNothing)
{
    TexturePool pool(size_t(64) << 20);
    Residency residency;
    residency.assign(pool, std::vector{feedbackAt(1.95f, {512, 512})}, 1);
    for (uint64_t frame = 2; frame < 20; ++frame) {
        residency.assign(pool, std::vector{feedbackAt(frame % 2 ? 1.95f : 2.05f, {512, 512})}, frame);
        EXPECT_FALSE(residency.objects()[0].fresh);
        EXPECT_EQ(residency.objects()[0].litLevel, 1u);
    }
}

TEST(Residency, TinyObjectsLeaveTextureSpaceWithoutAJumpAndReturnLater)
{
    TexturePool pool(size_t(64) << 20);
    Residency residency;
    const auto across = [](float lumels) { return feedbackAt(std::log2(512.0f / lumels), {512, 512}); };
    residency.assign(pool, std::vector{across(20.0f)}, 1);
    EXPECT_EQ(residency.objects()[0].share, 1.0f);
    float before = 1.0f;
    uint64_t frame = 2;
    for (; residency.objects()[0].share > 0.0f; ++frame) {
        residency.assign(pool, std::vector{across(5.0f)}, frame);
        EXPECT_LE(before - residency.objects()[0].share, 0.13f);
        before = residency.objects()[0].share;
        ASSERT_LT(frame, 20u);
    }
    EXPECT_FALSE(residency.objects()[0].texture);
    residency.assign(pool, std::vector{across(0.5f * (kLeave + kReturn))}, ++frame); // hysteresis
    EXPECT_EQ(residency.objects()[0].share, 0.0f);
    residency.assign(pool, std::vector{across(20.0f)}, ++frame);
    EXPECT_GT(residency.objects()[0].share, 0.0f);
    EXPECT_LT(residency.objects()[0].share, 0.2f);
}

TEST(Residency, ObjectsLeaveBeforeTheirChartsMerge)
{
    TexturePool pool(size_t(64) << 20);
    Residency residency;
    const auto at = [](float level) {
        ObjectFeedback n = feedbackAt(level, {1024, 1024});
        n.coarsest = 2.0f;
        return std::vector{n};
    };
    residency.assign(pool, at(2.0f + kLeaveLevel - 0.05f), 1);
    EXPECT_EQ(residency.objects()[0].share, 1.0f);
    uint64_t frame = 2;
    for (; residency.objects()[0].share > 0.0f && frame < 30; ++frame) // fades
        residency.assign(pool, at(2.0f + kLeaveLevel + 0.05f), frame);
    EXPECT_FALSE(residency.objects()[0].texture);
    EXPECT_GT(frame, 6u);
    residency.assign(pool, at(2.0f + 0.5f * (kLeaveLevel + kReturnLevel)), ++frame); // hysteresis
    EXPECT_EQ(residency.objects()[0].share, 0.0f);
    residency.assign(pool, at(2.0f), ++frame);
    EXPECT_GT(residency.objects()[0].share, 0.0f);
}

TEST(Residency, AnObjectWhoseFeedbackComesLateIsDrawnForwardAndFadesIn)
{
    TexturePool pool(size_t(64) << 20);
    std::vector<ObjectFeedback> feedback{feedbackAt(1.5f, {512, 512})};
    feedback[0].visible = false; // in view, but no sample of it is known yet
    Residency residency;
    residency.assign(pool, feedback, 1, true);
    EXPECT_FALSE(residency.objects()[0].texture);
    feedback[0].visible = true;
    float share = 0.0f;
    for (uint64_t frame = 2; frame < 20; ++frame) {
        residency.assign(pool, feedback, frame, true);
        ASSERT_TRUE(residency.objects()[0].texture);
        EXPECT_GE(residency.objects()[0].share, share);
        EXPECT_LE(residency.objects()[0].share, share + 0.25f);
        EXPECT_EQ(residency.steady(), residency.objects()[0].share == 1.0f);
        share = residency.objects()[0].share;
    }
    EXPECT_EQ(share, 1.0f);
}

TEST(Residency, AnObjectThatComesBackIntoViewGoesOnWithItsTexture)
{
    TexturePool pool(size_t(64) << 20);
    std::vector<ObjectFeedback> feedback{feedbackAt(1.5f, {512, 512})};
    Residency residency;
    residency.assign(pool, feedback, 1, true);
    const TextureId texture = residency.objects()[0].texture;
    ASSERT_TRUE(texture);
    feedback[0].inView = feedback[0].visible = false;
    residency.assign(pool, feedback, 2, true);
    EXPECT_FALSE(residency.objects()[0].texture);
    feedback[0].inView = true;
    residency.assign(pool, feedback, 3, true);
    EXPECT_EQ(residency.objects()[0].texture, texture);
    EXPECT_EQ(residency.objects()[0].share, 1.0f);
    EXPECT_FALSE(residency.objects()[0].fresh);
}
