// Still views: what they end at, and that the viewer then rests.
#include "view_fixture.h"

namespace lumel::view {
namespace {

class StillView : public View {};

TEST_F(StillView, StillViewsEndAtThePictureOfShot)
{
    start({"first.gltf", "--size", "700x300", "--budget-ms", "5", "--validate"});
    const Window window = display->find("first.gltf - Lumel");
    ASSERT_NE(window, 0u) << log();
    EXPECT_TRUE(endsAtThePictureOfShot(window)) << log();
    display->drag(window, 1, 100, 100, 180, 140);
    EXPECT_TRUE(endsAtThePictureOfShot(window)) << "after motion: " << log();
    display->resize(window, 760, 340);
    pause(200);
    EXPECT_TRUE(endsAtThePictureOfShot(window)) << "after a resize: " << log();
    display->key("v"); // another view and back
    pause(100);
    display->key("v", {"Shift_L"});
    EXPECT_TRUE(endsAtThePictureOfShot(window)) << log();
    display->key("q", {"Control_L"});
    EXPECT_EQ(finish(), 0) << log();
    EXPECT_EQ(log().find("vulkan:"), std::string::npos) << log();
}

TEST_F(StillView, RestsWhenNothingChanges)
{
    start({"first.gltf", "--size", "700x300"});
    const Window window = display->find("first.gltf - Lumel");
    ASSERT_NE(window, 0u) << log();
    EXPECT_TRUE(endsAtThePictureOfShot(window)) << log();
    pause(1000);
    const double before = processorSeconds();
    pause(3000);
    EXPECT_LT(processorSeconds() - before, 0.1);
    display->key("q", {"Control_L"});
    EXPECT_EQ(finish(), 0) << log();
}

TEST_F(StillView, RemembersThatTheHintWasDismissed)
{
    fs::remove(hintFile());
    start({"first.gltf", "--size", "700x300"});
    ASSERT_NE(display->find("first.gltf - Lumel"), 0u) << log();
    display->key("Escape");
    EXPECT_TRUE(appears(hintFile()));
    EXPECT_EQ(readText(hintFile()), "hint = off\n");
    display->key("q", {"Control_L"});
    EXPECT_EQ(finish(), 0) << log();
}

} // namespace
} // namespace lumel::view
