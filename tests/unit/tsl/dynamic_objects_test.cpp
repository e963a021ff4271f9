// Which objects' light changes frame after frame.
#include "tsl/dynamic_objects.h"
#include <gtest/gtest.h>

using lumel::tsl::DynamicObjects;

TEST(DynamicObjects, OccasionalChangesDoNotCount)
{
    DynamicObjects objects;
    for (int frame = 0; frame < 100; ++frame) {
        objects.note(3, frame % 4 == 0);
        EXPECT_FALSE(objects.is(3));
    }
    EXPECT_FALSE(objects.is(0)); // never in view
    EXPECT_FALSE(objects.is(9));
}

TEST(DynamicObjects, ChangesOfManyFramesCountUntilHardlyAnyFollow)
{
    DynamicObjects objects;
    for (int frame = 0; frame < 12; ++frame)
        objects.note(0, true);
    EXPECT_TRUE(objects.is(0));
    for (int frame = 0; frame < 100; ++frame) {
        objects.note(0, frame % 3 == 0); // an animation of 20 Hz in a picture of 60
        EXPECT_TRUE(objects.is(0));
    }
    for (int frame = 0; frame < 30; ++frame)
        objects.note(0, false);
    EXPECT_FALSE(objects.is(0));
}
