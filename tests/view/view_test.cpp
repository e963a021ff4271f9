// The viewer in use: a real window on an X server, real keys and mouse, a real drop.
#include "../cli/inputs.h"
#include "../cli/program.h"
#include "core/image.h"
#include "display.h"
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <fstream>
#include <numeric>
#include <sstream>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

namespace lumel::view {
namespace {

namespace fs = std::filesystem;

using cli::readText;

Display* display = nullptr;

class View : public ::testing::Test {
protected:
    static void SetUpTestSuite() { display = new Display; }
    static void TearDownTestSuite()
    {
        delete display;
        display = nullptr;
    }
    void SetUp() override
    {
        if (!display->started())
            GTEST_SKIP() << "Xvfb is missing: the viewer is NOT tested; install xvfb";
        std::string pattern = (fs::temp_directory_path() / "lumel-view-XXXXXX").string();
        ASSERT_NE(mkdtemp(pattern.data()), nullptr);
        folder_ = pattern;
        fs::create_directory(folder_ / "cache");
        fs::create_directories(hintFile().parent_path());
        std::ofstream(hintFile()) << "hint = off\n";
        for (const char* name : {"first", "second"}) {
            const fs::path file = folder_ / (std::string(name) + ".gltf");
            nlohmann::json scene = cli::squareScene(file);
            scene["materials"][0]["name"] = "relief";
            cli::writeScene(file, scene);
        }
    }
    void TearDown() override
    {
        if (child_ > 0) {
            kill(child_, SIGKILL);
            waitpid(child_, nullptr, 0);
        }
        std::error_code ignored;
        if (!folder_.empty())
            fs::remove_all(folder_, ignored);
    }

    void start(std::vector<std::string> arguments)
    {
        arguments.insert(arguments.begin(), {LUMEL_PROGRAM, "view"});
        child_ = fork();
        if (child_ != 0)
            return;
        const int log = open((folder_ / "cache" / "log").c_str(), O_CREAT | O_TRUNC | O_WRONLY, 0600);
        dup2(log, STDOUT_FILENO);
        dup2(log, STDERR_FILENO);
        setenv("XDG_CACHE_HOME", (folder_ / "cache").c_str(), 1);
        setenv("XDG_CONFIG_HOME", (folder_ / "config").c_str(), 1);
        setenv("DISPLAY", display->name().c_str(), 1);
        unsetenv("WAYLAND_DISPLAY");
        std::vector<char*> argv;
        for (std::string& argument : arguments)
            argv.push_back(argument.data());
        argv.push_back(nullptr);
        if (chdir(folder_.c_str()) == 0)
            execv(LUMEL_PROGRAM, argv.data());
        _exit(127);
    }

    // The exit code; -1 when it did not end by itself.
    int finish(double seconds = 30.0)
    {
        for (int i = 0; i < int(seconds * 50.0); ++i) {
            int status = 0;
            if (waitpid(child_, &status, WNOHANG) == child_) {
                child_ = 0;
                return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
            }
            pause(20);
        }
        return -1;
    }

    std::string log() const { return readText(folder_ / "cache" / "log"); }

    bool says(const std::string& words) const
    {
        for (int i = 0; i < 1500 && log().find(words) == std::string::npos; ++i)
            pause(20);
        return log().find(words) != std::string::npos;
    }

    bool appears(const fs::path& file, double seconds = 30.0)
    {
        for (int i = 0; i < int(seconds * 50.0) && !fs::exists(folder_ / file); ++i)
            pause(20);
        return fs::exists(folder_ / file);
    }

    // Takes a screenshot by key; the picture (of the left side, where it is split).
    Image screenshot(bool split = false)
    {
        ++shots_;
        const std::string stem = (shots_ < 10 ? "lumel-00" : "lumel-0") + std::to_string(shots_);
        display->key("F12");
        EXPECT_TRUE(appears(stem + ".txt")) << log();
        std::vector<std::string> names{stem + (split ? "-left.png" : ".png")};
        if (split)
            names.push_back(stem + "-right.png");
        std::vector<Image> seen;
        for (const std::string& name : names)
            seen.push_back(readImage(folder_ / name));
        rerun(readText(folder_ / (stem + ".txt")));
        for (size_t i = 0; i < names.size(); ++i) {
            const Image again = readImage(folder_ / names[i]);
            EXPECT_EQ(again.width, seen[i].width);
            EXPECT_EQ(again.pixels, seen[i].pixels) << names[i] << ": the command gives another picture";
        }
        return seen.front();
    }

    // Runs commands that the viewer wrote.
    void rerun(const std::string& commands)
    {
        const std::string script = "cd '" + folder_.string() + "' && export XDG_CACHE_HOME='" +
                                   (folder_ / "cache").string() + "' PATH='" +
                                   fs::path(LUMEL_PROGRAM).parent_path().string() +
                                   "':\"$PATH\" && set -e\n" + commands;
        const std::string file = (folder_ / "cache" / "again.sh").string();
        std::ofstream(file) << script;
        EXPECT_EQ(std::system(("sh '" + file + "' > /dev/null").c_str()), 0) << commands;
    }

    long residentKiB() const
    {
        std::istringstream status(readText("/proc/" + std::to_string(child_) + "/status"));
        std::string word;
        while (status >> word)
            if (word == "VmRSS:") {
                long kib = 0;
                status >> kib;
                return kib;
            }
        return 0;
    }

    fs::path hintFile() const { return folder_ / "config" / "lumel" / "viewer.conf"; }

    // Whether the window comes to show, bit for bit, what the command of the view renders: below the label at
    // the top, above messages.
    bool endsAtThePictureOfShot(Window window)
    {
        display->key("c");
        std::string command;
        for (int i = 0; i < 200 && command.rfind("lumel shot", 0) != 0; ++i) {
            pause(50);
            command = display->clipboard();
        }
        rerun(command);
        const Image picture = readImage(folder_ / "lumel.png");
        const int top = 45, height = picture.height - top - 5;
        std::vector<uint8_t> expected;
        for (int y = top; y < top + height; ++y)
            for (int i = 0; i < 3 * picture.width; ++i)
                expected.push_back(uint8_t(std::lround(255.0f * picture.at(0, y)[i])));
        for (int i = 0; i < 600; ++i, pause(100)) // messages go after a few seconds
            if (display->pixels(window, 0, top, picture.width, height) == expected)
                return true;
        return false;
    }

    // Seconds of processor time that the viewer has used.
    double processorSeconds() const
    {
        std::istringstream status(readText("/proc/" + std::to_string(child_) + "/stat"));
        std::string word;
        for (int i = 0; i < 13; ++i) // its name has no spaces
            status >> word;
        double user = 0.0, system = 0.0;
        status >> user >> system;
        return (user + system) / double(sysconf(_SC_CLK_TCK));
    }

    fs::path folder_;
    pid_t child_ = 0;
    int shots_ = 0;
};

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

TEST_F(View, StillViewsEndAtThePictureOfShot)
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

TEST_F(View, RestsWhenNothingChanges)
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

TEST_F(View, RemembersThatTheHintWasDismissed)
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

TEST_F(View, PlaysAnimationsAndCopiesTheirSecond)
{
    nlohmann::json scene = cli::squareScene(folder_ / "moves.gltf");
    cli::addMotion(scene, folder_ / "moves.gltf", 0, {0, 0, 0}, {0.5f, 0, 0});
    cli::writeScene(folder_ / "moves.gltf", scene);
    start({"moves.gltf", "--size", "700x300", "--validate"});
    ASSERT_NE(display->find("moves.gltf - Lumel"), 0u) << log();
    const Image first = screenshot(); // equal to what its command renders, --time included
    EXPECT_NE(readText(folder_ / "lumel-001.txt").find("--time "), std::string::npos);
    pause(300);
    EXPECT_NE(screenshot().pixels, first.pixels); // it continues
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
    const fs::path shaders = folder_ / "cache" / "shaders", file = shaders / "display.comp";
    fs::copy(LUMEL_SHADERS, shaders, fs::copy_options::recursive);
    setenv("LUMEL_SHADERS", shaders.c_str(), 1);
    start({"first.gltf", "--size", "700x300"});
    unsetenv("LUMEL_SHADERS");
    ASSERT_NE(display->find("first.gltf - Lumel"), 0u) << log();
    const Image before = screenshot();
    const std::string code = readText(file);
    std::ofstream(file) << code << "\nbroken\n";
    display->key("r");
    ASSERT_TRUE(says("display.comp: ERROR")) << log();
    EXPECT_EQ(screenshot().pixels, before.pixels);

    std::string darker = code;
    const std::string weight = "* push.weight";
    ASSERT_NE(darker.find(weight), std::string::npos);
    darker.replace(darker.find(weight), weight.size(), "* push.weight * 0.25");
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
    display->key("q", {"Control_L"});
    EXPECT_EQ(finish(), 0) << log();
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
