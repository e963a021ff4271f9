// The viewer in use: a real window on an X server, real keys and mouse, a real drop.
#include "view_fixture.h"

namespace lumel::view {
namespace {

TEST_F(View, ShowsWhatTheCopiedCommandRenders)
{
    start({"first.gltf", "--size", "700x300", "--validate"});
    const Window window = display->find("first.gltf - Lumel");
    ASSERT_NE(window, 0u) << log();
    const Image still = screenshot();

    display->drag(window, 1, 100, 100, 180, 140); // turns
    const Image turned = screenshot();
    EXPECT_NE(turned.pixels, still.pixels);

    display->moveTo(window, 100, 100);
    display->key("2"); // forward
    const Image forward = screenshot();
    EXPECT_NE(forward.pixels, turned.pixels);

    display->key("x");                                // split: the reference at the right
    display->drag(window, 1, 328 / 2, 150, 100, 150); // its line
    const Image left = screenshot(true);
    EXPECT_EQ(left.pixels, forward.pixels); // dragging the line turned nothing

    display->key("c");
    const std::string copied = display->clipboard();
    EXPECT_EQ(copied.rfind("lumel shot ", 0), 0u) << copied;
    EXPECT_NE(copied.find("--shading reference"), std::string::npos) << copied;

    display->key("Home");
    display->key("x");
    display->key("1");
    EXPECT_EQ(screenshot().pixels, still.pixels);
    display->key("q", {"Control_L"});
    EXPECT_EQ(finish(), 0) << log();
    EXPECT_EQ(log().find("vulkan:"), std::string::npos) << log();
}

TEST_F(View, PlaysAnimationsAndCopiesTheirSecond)
{
    nlohmann::json scene = cli::squareScene(folder_ / "moves.gltf");
    cli::addMotion(scene, folder_ / "moves.gltf", 0, {0, 0, 0}, {0.5f, 0, 0});
    cli::writeScene(folder_ / "moves.gltf", scene);
    start({"moves.gltf", "--size", "700x300", "--validate"});
    ASSERT_NE(display->find("moves.gltf - Lumel"), 0u) << log();
    const Image first = screenshot(); // equal to what its command renders, --time included
    EXPECT_NE(readText(folder_ / "lumel-001.txt").find("--time "), std::string::npos);
    Image later = first; // it continues, however busy the machine
    for (int i = 0; i < 10 && later.pixels == first.pixels; ++i) {
        pause(300);
        later = screenshot();
    }
    EXPECT_NE(later.pixels, first.pixels);
    display->key("p");
    pause(300);
    const Image stopped = screenshot();
    pause(300);
    EXPECT_EQ(screenshot().pixels, stopped.pixels);
    display->key("q", {"Control_L"});
    EXPECT_EQ(finish(), 0) << log();
    EXPECT_EQ(log().find("vulkan:"), std::string::npos) << log();
}

TEST_F(View, AutomaticExposureIsANumberInTheCopiedCommand)
{
    nlohmann::json scene = cli::squareScene(folder_ / "bright.gltf");
    cli::addLight(scene, "directional", 100000.0f);
    cli::writeScene(folder_ / "bright.gltf", scene);
    start({"bright.gltf", "--size", "700x300", "--validate"});
    const Window window = display->find("bright.gltf - Lumel");
    ASSERT_NE(window, 0u) << log();
    EXPECT_TRUE(says(" (auto)")) << log();
    const Image picture = screenshot(); // equal to what its command renders
    EXPECT_NE(readText(folder_ / "lumel-001.txt").find("--exposure "), std::string::npos);
    const float middle = *picture.at(picture.width / 2, picture.height / 2);
    EXPECT_GT(middle, 0.3f);
    EXPECT_LT(middle, 0.8f);
    display->drag(window, 1, 100, 100, 220, 100); // turns: the exposure adapts
    pause(1500);
    screenshot();
    display->key("q", {"Control_L"});
    EXPECT_EQ(finish(), 0) << log();
    EXPECT_EQ(log().find("vulkan:"), std::string::npos) << log();
}

TEST_F(View, TakesDropsAndKeepsTheOldSceneWhenOneFails)
{
    start({"first.gltf", "--size", "700x300", "--validate"});
    const Window window = display->find("first.gltf - Lumel");
    ASSERT_NE(window, 0u) << log();
    std::ofstream(folder_ / "broken.gltf") << "{ no scene";
    ASSERT_TRUE(display->drop(window, folder_ / "broken.gltf", 100, 100));
    EXPECT_TRUE(says("broken.gltf")) << log();
    EXPECT_NE(display->find("first.gltf - Lumel"), 0u);

    ASSERT_TRUE(display->drop(window, folder_ / "second.gltf", 100, 100));
    EXPECT_NE(display->find("second.gltf - Lumel"), 0u) << log();
    EXPECT_GT(screenshot().width, 0);

    // A baked file onto the surface in the middle of the picture: matte blue.
    rerun("lumel bake --height first.png --height-scale 0.02 --specular 0 --diffuse 0.1,0.2,0.8 -o blue.exr");
    ASSERT_TRUE(display->drop(window, folder_ / "blue.exr", 160, 150));
    ASSERT_TRUE(says("replaces the material")) << log();
    const Image blue = screenshot();
    const float* middle = blue.at(blue.width / 2, blue.height / 2);
    EXPECT_GT(middle[2], 1.3f * middle[0]);
    display->key("q", {"Control_L"});
    EXPECT_EQ(finish(), 0) << log();
    EXPECT_EQ(log().find("vulkan:"), std::string::npos) << log();
}

TEST_F(View, SurvivesManyResizes)
{
    start({"first.gltf", "--size", "700x300", "--validate", "--split"});
    const Window window = display->find("first.gltf - Lumel");
    ASSERT_NE(window, 0u) << log();
    display->key("F12"); // makes all renderers that there will be
    ASSERT_TRUE(appears("lumel-001.txt")) << log();
    ++shots_;
    long before = 0;
    for (int i = 0; i < 100; ++i) {
        display->resize(window, 420 + 37 * (i % 11), 250 + 23 * (i % 7));
        pause(20);
        if (i % 25 == 24) { // off screen and back
            display->show(window, false);
            display->show(window, true);
        }
        if (i == 49)
            before = residentKiB();
    }
    EXPECT_LT(residentKiB() - before, 40 * 1024);
    display->resize(window, 800, 400);
    display->key("x");
    pause(500);
    const Image picture = screenshot();
    EXPECT_EQ(picture.width, 800 - 372);
    EXPECT_EQ(picture.height, 400);
    display->key("h"); // without panels
    const Image wide = screenshot();
    EXPECT_EQ(wide.width, 800);
    display->key("q", {"Control_L"});
    EXPECT_EQ(finish(), 0) << log();
    EXPECT_EQ(log().find("vulkan:"), std::string::npos) << log();
}

TEST_F(View, ReloadsShadersAndKeepsTheOldOnesWhenOneIsBroken)
{
    const fs::path shaders = folder_ / "cache" / "shaders", file = shaders / "edges_find.comp";
    fs::copy(LUMEL_SHADERS, shaders, fs::copy_options::recursive);
    setenv("LUMEL_SHADERS", shaders.c_str(), 1);
    start({"first.gltf", "--size", "700x300"});
    unsetenv("LUMEL_SHADERS");
    ASSERT_NE(display->find("first.gltf - Lumel"), 0u) << log();
    const Image before = screenshot();
    const std::string code = readText(file);
    std::ofstream(file) << code << "\nbroken\n";
    display->key("r");
    ASSERT_TRUE(says("edges_find.comp: ERROR")) << log();
    EXPECT_EQ(screenshot().pixels, before.pixels);

    std::string darker = code;
    const std::string shown = "displayed(radiance.rgb)";
    ASSERT_NE(darker.find(shown), std::string::npos);
    darker.replace(darker.find(shown), shown.size(), "displayed(0.25 * radiance.rgb)");
    std::ofstream(file) << darker;
    display->key("r");
    ASSERT_TRUE(says("shaders reloaded")) << log();
    display->key("F12", {"Shift_L"}); // linear radiance, from before the display pass
    ASSERT_TRUE(appears("lumel-003.txt"));
    EXPECT_TRUE(fs::exists(folder_ / "lumel-003.exr"));
    display->key("F12");
    ASSERT_TRUE(appears("lumel-004.txt"));
    const Image dark = readImage(folder_ / "lumel-004.png");
    const auto sum = [](const Image& image) {
        return std::accumulate(image.pixels.begin(), image.pixels.end(), 0.0);
    };
    EXPECT_LT(sum(dark), 0.8 * sum(before));
    display->key("q", {"Control_L"});
    EXPECT_EQ(finish(), 0) << log();
}

TEST_F(View, QuitsWhileBaking)
{
    cli::writeHeightMap(folder_ / "first.png", 1024, 1024);
    start({"first.gltf", "--size", "700x300", "--validate"});
    const Window window = display->find("Lumel (loading)");
    ASSERT_NE(window, 0u) << log();
    ASSERT_NE(display->find("first.gltf - Lumel (baking)"), 0u) << log();
    display->key("q", {"Control_L"});
    EXPECT_EQ(finish(), 0) << log();
    EXPECT_EQ(log().find("baked after"), std::string::npos) << log();
    EXPECT_EQ(log().find("vulkan:"), std::string::npos) << log();
}

TEST_F(View, SaysWhenThereIsNoDisplayOrNoScene)
{
    const std::string program = LUMEL_PROGRAM;
    const std::string file = (folder_ / "message").string();
    const auto oneLine = [&](const std::string& command, const char* mentions) {
        const int status = std::system((command + " 2> '" + file + "'").c_str());
        EXPECT_EQ(WEXITSTATUS(status), 1);
        const std::string message = readText(file);
        EXPECT_EQ(std::count(message.begin(), message.end(), '\n'), 1) << message;
        EXPECT_NE(message.find(mentions), std::string::npos) << message;
    };
    oneLine("env -u DISPLAY -u WAYLAND_DISPLAY '" + program + "' view", "DISPLAY");
    oneLine("env DISPLAY=" + display->name() + " '" + program + "' view /nowhere.gltf", "/nowhere.gltf");
}

} // namespace
} // namespace lumel::view
