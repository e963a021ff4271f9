#include "inputs.h"
#include "program.h"
#include <OpenImageIO/imageio.h>
#include <algorithm>
#include <set>

namespace lumel::cli {
namespace {

namespace fs = std::filesystem;

class Bake : public Program {
protected:
    // Names in the working folder apart from the cache.
    std::set<std::string> files() const
    {
        std::set<std::string> names;
        for (const auto& entry : fs::directory_iterator(folder_))
            if (entry.path().filename() != "cache")
                names.insert(entry.path().filename().string());
        return names;
    }
};

TEST_F(Bake, EmptyImageFails)
{
    writeText(folder_ / "empty.png", "");
    expectOneLine(run({"bake", "--normal", "empty.png", "-o", "out.exr"}), 1, "empty.png");
    EXPECT_EQ(files(), std::set<std::string>({"empty.png"}));
}

TEST_F(Bake, TextFileFails)
{
    writeText(folder_ / "notes.png", "This is not a picture.\n");
    expectOneLine(run({"bake", "--normal", "notes.png", "-o", "out.exr"}), 1, "notes.png");
    EXPECT_EQ(files(), std::set<std::string>({"notes.png"}));
}

TEST_F(Bake, TruncatedImageFails)
{
    writeHeightMap(folder_ / "whole.png", 64, 64);
    const std::string bytes = readText(folder_ / "whole.png");
    writeText(folder_ / "cut.png", bytes.substr(0, bytes.size() / 2));
    expectOneLine(run({"bake", "--height", "cut.png", "--height-scale", "0.02", "-o", "out.exr"}), 1,
                  "lumel: cut.png: damaged image");
    EXPECT_FALSE(fs::exists(folder_ / "out.exr"));
}

TEST_F(Bake, MissingMapFails)
{
    expectOneLine(run({"bake", "--normal", "nowhere.png", "-o", "out.exr"}), 1, "nowhere.png");
}

TEST_F(Bake, MissingOutputFolderFails)
{
    writeHeightMap(folder_ / "h.png", 16, 16);
    expectOneLine(run({"bake", "--height", "h.png", "--height-scale", "0.02", "-o", "none/out.exr"}), 1,
                  "none");
    EXPECT_FALSE(fs::exists(folder_ / "none"));
}

TEST_F(Bake, UsageErrorsExitWithTwo)
{
    writeHeightMap(folder_ / "h.png", 16, 16);
    expectOneLine(run({"bake", "--height", "h.png", "--frobnicate", "-o", "out.exr"}), 2, "--frobnicate");
    expectOneLine(run({"bake", "-o", "out.exr"}), 2, "--height");
    expectOneLine(run({"bake", "--height", "h.png", "--method", "magic", "-o", "out.exr"}), 2, "--method");
    expectOneLine(run({"bake", "--height", "h.png", "--lobes", "3", "-o", "out.exr"}), 2, "--lobes");
    expectOneLine(run({"bake", "--height", "h.png", "--height-scale", "steep", "-o", "out.exr"}), 2,
                  "--height-scale");
    EXPECT_EQ(files(), std::set<std::string>({"h.png"}));
}

TEST_F(Bake, WritesEveryLevelAsTheFormatSays)
{
    writeHeightMap(folder_ / "h.png", 96, 40);
    const Outcome outcome =
        run({"bake", "--height", "h.png", "--height-scale", "0.02", "--power", "150", "-o", "out.exr"});
    ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
    EXPECT_NE(outcome.out.find("out.exr"), std::string::npos);
    EXPECT_EQ(files(), std::set<std::string>({"h.png", "out.exr"}));

    const auto input = OIIO::ImageInput::open((folder_ / "out.exr").string());
    ASSERT_TRUE(input) << OIIO::geterror();
    const std::set<std::string> channels{"N.x",   "N.y",   "S.xx",  "S.xy",  "S.yy",  "Ks.R", "Ks.G",
                                         "Ks.B",  "Kd.R",  "Kd.G",  "Kd.B",  "E",     "N2.x", "N2.y",
                                         "S2.xx", "S2.xy", "S2.yy", "Ks2.R", "Ks2.G", "Ks2.B"};
    const int sizes[][2] = {{96, 40}, {48, 20}, {24, 10}, {12, 5},
                            {6, 2},   {3, 1},   {1, 1}}; // floor(size / 2^L)
    int level = 0;
    for (; input->seek_subimage(0, level); ++level) {
        ASSERT_LT(level, 7);
        const OIIO::ImageSpec spec = input->spec();
        EXPECT_EQ(spec.width, sizes[level][0]);
        EXPECT_EQ(spec.height, sizes[level][1]);
        EXPECT_GT(spec.tile_width, 0);
        EXPECT_EQ(spec.format, OIIO::TypeDesc(OIIO::TypeDesc::HALF));
        EXPECT_EQ(std::set<std::string>(spec.channelnames.begin(), spec.channelnames.end()), channels);
        if (level == 0) {
            for (const char* name : {"lumel:model", "lumel:method", "lumel:version", "lumel:source"})
                EXPECT_NE(spec.get_string_attribute(name), "") << name;
        }
    }
    EXPECT_EQ(level, 7);
}

TEST_F(Bake, SameInputsGiveTheSameBytes)
{
    writeHeightMap(folder_ / "h.png", 50, 34);
    for (const char* lobes : {"1", "auto"}) {
        const auto bake = [&](const char* threads, const char* out) {
            const Outcome outcome = run({"bake", "--height", "h.png", "--height-scale", "0.2", "--lobes",
                                         lobes, "--threads", threads, "-o", out});
            EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
            return readText(folder_ / out);
        };
        const std::string first = bake("1", "a.exr");
        EXPECT_EQ(first.find("Ks2.R") != std::string::npos, lobes == std::string("auto"));
        EXPECT_TRUE(first == bake("1", "b.exr"));
        EXPECT_TRUE(first == bake("2", "c.exr")) << "the result depends on the number of threads";
    }
}

TEST_F(Bake, InterruptLeavesNoOutput)
{
    writeHeightMap(folder_ / "h.png", 2048, 2048); // seconds of work
    writeText(folder_ / "out.exr", "what was there before");
    const Outcome outcome = runAndInterrupt(
        {"bake", "--height", "h.png", "--height-scale", "0.002", "--threads", "1", "-o", "out.exr"}, 700);
    expectOneLine(outcome, 130, "interrupted");
    EXPECT_EQ(files(), std::set<std::string>({"h.png", "out.exr"}));
    EXPECT_EQ(readText(folder_ / "out.exr"), "what was there before");
}

} // namespace
} // namespace lumel::cli
