// Untrusted images: damaged, foreign and hostile ones end in one line; no process is left behind.
#include "../image_files.h"
#include "inputs.h"
#include "program.h"
#include <chrono>
#include <csignal>
#include <fstream>
#include <optional>
#include <sstream>
#include <thread>

namespace lumel::cli {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

// The state and the parent of a process (proc(5), /proc/pid/stat); nothing when there is none, or only what
// its parent has not yet asked for.
std::optional<pid_t> parentOf(pid_t process)
{
    std::ifstream stream("/proc/" + std::to_string(process) + "/stat");
    std::string line;
    if (!std::getline(stream, line))
        return std::nullopt;
    std::istringstream rest(line.substr(line.rfind(')') + 1)); // the name in between may hold anything
    char state = 0;
    pid_t parent = 0;
    rest >> state >> parent;
    return state == 'Z' || state == 'X' ? std::nullopt : std::optional(parent);
}

std::vector<pid_t> childrenOf(pid_t parent)
{
    std::vector<pid_t> children;
    for (const auto& entry : fs::directory_iterator("/proc")) {
        const pid_t process = std::atoi(entry.path().filename().c_str());
        if (process > 0 && parentOf(process) == parent)
            children.push_back(process);
    }
    return children;
}

class ImageFiles : public Program {
protected:
    Outcome bake(const std::string& map)
    {
        return run({"bake", "--height", map, "--height-scale", "0.02", "-o", "out.exr"});
    }
    void expectRefused(const std::string& map)
    {
        expectOneLine(bake(map), 1, "lumel: " + map + ": ");
        EXPECT_FALSE(fs::exists(folder_ / "out.exr")) << map;
    }
    // The first part of a file of that format.
    std::string cutFile(const std::string& ending, double share)
    {
        test::writeImageFile(folder_ / ("whole." + ending), 64, 64);
        const std::string bytes = test::bytesOf(folder_ / ("whole." + ending));
        test::writeBytes(folder_ / ("cut." + ending), bytes.substr(0, size_t(share * double(bytes.size()))));
        return "cut." + ending;
    }
    // Waits for a process to have a child.
    static pid_t childOf(pid_t parent)
    {
        for (int i = 0; i < 1000; ++i) {
            const auto children = childrenOf(parent);
            if (!children.empty())
                return children.front();
            std::this_thread::sleep_for(10ms);
        }
        ADD_FAILURE() << "no child of " << parent;
        return -1;
    }
    static void expectGone(pid_t process)
    {
        for (int i = 0; i < 200 && parentOf(process); ++i)
            std::this_thread::sleep_for(10ms);
        EXPECT_FALSE(parentOf(process)) << process << " lives on";
    }
};

TEST_F(ImageFiles, DamagedFilesOfEachFormatAreOneLine)
{
    for (const char* ending : test::kReadEndings)
        expectRefused(cutFile(ending, 0.6));
}

TEST_F(ImageFiles, OtherFormatsAreOneLineWhateverTheirName)
{
    for (const char* format : {"bmp", "ico", "gif", "dds"}) {
        test::writeBytes(folder_ / "map.png", test::foreignFile(format, folder_));
        expectRefused("map.png");
    }
}

TEST_F(ImageFiles, CrashesOfOpenImageIoAreOneLine)
{
    test::writeImageFile(folder_ / "plain.png", 16, 16);
    test::writeBytes(folder_ / "nested.png", test::withNestedMetadata(test::bytesOf(folder_ / "plain.png")));
    expectRefused("nested.png");
}

TEST_F(ImageFiles, JpegBombsAreCut)
{
    test::writeBytes(folder_ / "bomb.jpg", test::jpegBomb(4096, 20000));
    expectOneLine(bake("bomb.jpg"), 1, "bomb.jpg: damaged image (decoding it takes longer");
    EXPECT_FALSE(fs::exists(folder_ / "out.exr"));
}

TEST_F(ImageFiles, BakedFilesEnvironmentMapsAndPicturesAreReadTheSameWay)
{
    writeHeightMap(folder_ / "h.png", 64, 64);
    ASSERT_EQ(run({"bake", "--height", "h.png", "--height-scale", "0.02", "-o", "baked.exr"}).exitCode, 0);
    const std::string whole = test::bytesOf(folder_ / "baked.exr");
    test::writeBytes(folder_ / "half.exr", whole.substr(0, whole.size() / 2));
    auto scene = squareScene(folder_ / "a.gltf");
    scene["materials"][0]["name"] = "stone";
    writeScene(folder_ / "a.gltf", scene);
    expectOneLine(run({"shot", "a.gltf", "-o", "o.png", "--material", "stone=half.exr"}), 1, "half.exr: ");
    const std::string hdr = cutFile("hdr", 0.6);
    expectOneLine(run({"shot", "a.gltf", "-o", "o.png", "--environment", hdr}), 1, hdr + ": damaged image");
    const std::string png = cutFile("png", 0.6);
    expectOneLine(run({"compare", "whole.png", png}), 1, png + ": damaged image");
    // An image of the scene itself.
    test::writeBytes(folder_ / "a.png", test::bytesOf(folder_ / png));
    expectOneLine(run({"shot", "a.gltf", "-o", "o.png"}), 1, "a.png: damaged image");
    test::writeBytes(folder_ / "a.png", test::foreignFile("bmp", folder_));
    expectOneLine(run({"shot", "a.gltf", "-o", "o.png"}), 1, "its content is not PNG, JPEG or WebP");
    EXPECT_FALSE(fs::exists(folder_ / "o.png"));
}

TEST_F(ImageFiles, WithoutTheDecoderEachMapIsALine)
{
    writeHeightMap(folder_ / "h.png", 1024, 1024); // seconds of baking
    writeText(folder_ / "list.json",
              R"([{"output": "a.exr", "height": "h.png", "height-scale": 0.001, "threads": 1},
                  {"output": "b.exr", "height": "h.png", "height-scale": 0.001, "method": "average"}])");
    const pid_t program = start({"bake", "--manifest", "list.json"});
    const pid_t zygote = childOf(program);
    // The first map has been read when its output is begun.
    const auto begun = [&] {
        return std::ranges::any_of(fs::directory_iterator(folder_), [](const fs::directory_entry& entry) {
            return entry.path().filename().string().starts_with(".a.");
        });
    };
    for (int i = 0; i < 3000 && !begun(); ++i)
        std::this_thread::sleep_for(10ms);
    kill(zygote, SIGKILL);
    const Outcome outcome = finish(program);
    EXPECT_EQ(outcome.exitCode, 1);
    EXPECT_NE(outcome.out.find("h.png: the image decoder's process has ended"), std::string::npos)
        << outcome.out << outcome.err;
    EXPECT_TRUE(fs::exists(folder_ / "a.exr"));
}

TEST_F(ImageFiles, NoProcessOutlivesTheProgram)
{
    test::writeBytes(folder_ / "bomb.jpg", test::jpegBomb(4096, 20000));
    for (const int signal : {SIGINT, SIGTERM, SIGKILL}) {
        const pid_t program = start({"bake", "--height", "bomb.jpg", "-o", "out.exr"});
        const pid_t zygote = childOf(program), child = childOf(zygote);
        if (signal != SIGKILL) { // a terminal's Ctrl-C goes to all of them
            kill(child, signal);
            kill(zygote, signal);
        }
        kill(program, signal);
        const Outcome outcome = finish(program);
        if (signal != SIGKILL)
            expectOneLine(outcome, 130, "interrupted");
        expectGone(zygote);
        expectGone(child);
    }
}

} // namespace
} // namespace lumel::cli
