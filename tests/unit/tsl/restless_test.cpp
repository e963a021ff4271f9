// Which objects' light changes frame after frame.
#include "tsl/restless.h"
#include <gtest/gtest.h>

using lumel::tsl::Restless;

TEST(Restless, AChangeNowAndThenIsNone)
{
    Restless restless;
    for (int frame = 0; frame < 100; ++frame) {
        restless.note(3, frame % 4 == 0);
        EXPECT_FALSE(restless.is(3));
    }
    EXPECT_FALSE(restless.is(0)); // never in view
    EXPECT_FALSE(restless.is(9));
}

TEST(Restless, ChangesOfManyFramesMakeItSoUntilHardlyAnyFollow)
{
    Restless restless;
    for (int frame = 0; frame < 12; ++frame)
        restless.note(0, true);
    EXPECT_TRUE(restless.is(0));
    for (int frame = 0; frame < 100; ++frame) {
        restless.note(0, frame % 3 == 0); // an animation of 20 Hz in a picture of 60
        EXPECT_TRUE(restless.is(0));
    }
    for (int frame = 0; frame < 30; ++frame)
        restless.note(0, false);
    EXPECT_FALSE(restless.is(0));
}
