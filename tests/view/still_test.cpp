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

TEST_F(StillView, EndsAtThePictureOfShotAfterALightWasMovedAndPutBack)
{
    nlohmann::json scene = cli::squareScene(folder_ / "lit.gltf");
    cli::addLight(scene, "directional", 2.0f);
    cli::writeScene(folder_ / "lit.gltf", scene);
    start({"lit.gltf", "--size", "700x600", "--validate"});
    const Window window = display->find("lit.gltf - Lumel");
    ASSERT_NE(window, 0u) << log();
    ASSERT_TRUE(endsAtThePictureOfShot(window)) << log();
    const auto picture = [&] { return display->pixels(window, 0, 45, 328, 500); };
    const std::vector<uint8_t> before = picture();
    display->drag(window, 1, 567, 22, 567, 22);   // the tab of the lights
    display->drag(window, 1, 488, 279, 560, 279); // a part of the first one's direction
    EXPECT_TRUE(endsAtThePictureOfShot(window)) << log();
    EXPECT_NE(display->clipboard().find("--light sun"), std::string::npos) << display->clipboard();
    EXPECT_TRUE(picture() != before);
    display->key("Home");
    pause(200);
    EXPECT_TRUE(endsAtThePictureOfShot(window)) << log();
    EXPECT_TRUE(picture() == before);
    display->key("q", {"Control_L"});
    EXPECT_EQ(finish(), 0) << log();
    EXPECT_EQ(log().find("vulkan:"), std::string::npos) << log();
}

// Placeholders first; a screenshot waits for what replaces them.
TEST_F(StillView, ShowsASceneBeforeItIsBakedAndEndsAtThePictureOfShot)
{
    cli::writeHeightMap(folder_ / "first.png", 512, 512);
    start({"first.gltf", "--size", "700x300", "--validate"});
    const Window window = display->find("first.gltf - Lumel (baking)");
    ASSERT_NE(window, 0u) << log();
    EXPECT_TRUE(says("shown after")) << log();
    EXPECT_EQ(log().find("baked after"), std::string::npos) << log();
    display->key("F12");
    ASSERT_TRUE(appears("lumel-001.txt")) << log();
    EXPECT_NE(log().find("baked after"), std::string::npos) << log();
    const Image seen = readImage(folder_ / "lumel-001.png");
    rerun(readText(folder_ / "lumel-001.txt"));
    EXPECT_EQ(readImage(folder_ / "lumel-001.png").pixels, seen.pixels);
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
