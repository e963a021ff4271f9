// A viewer under test: started on a display of its own, with folders of its own.
#pragma once
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
namespace fs = std::filesystem;

using cli::readText;

inline Display* display = nullptr;

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
        std::string command; // nothing before the first picture
        for (int i = 0; i < 60 && command.rfind("lumel shot", 0) != 0; ++i) {
            display->key("c");
            pause(500);
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

} // namespace lumel::view
