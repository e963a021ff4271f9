#include "core/image.h"
#include "inputs.h"
#include "program.h"
#include <algorithm>

namespace lumel::cli {
namespace {

namespace fs = std::filesystem;

class Shot : public Program {};

TEST_F(Shot, MissingSceneFails)
{
    expectOneLine(run({"shot", "nowhere.gltf", "-o", "out.png"}), 1, "nowhere.gltf");
}

TEST_F(Shot, TextFileNamedGlbFails)
{
    writeText(folder_ / "poem.glb", "Roses are red, this is no scene.\n");
    expectOneLine(run({"shot", "poem.glb", "-o", "out.png"}), 1, "poem.glb");
    writeText(folder_ / "poem.gltf", "Roses are red, this is no scene.\n");
    expectOneLine(run({"shot", "poem.gltf", "-o", "out.png"}), 1, "poem.gltf");
    EXPECT_FALSE(fs::exists(folder_ / "out.png"));
}

TEST_F(Shot, AccessorBeyondItsBufferFails)
{
    auto document = squareScene(folder_ / "square.gltf");
    document["accessors"][0]["count"] = 1000;
    writeScene(folder_ / "square.gltf", document);
    expectOneLine(run({"shot", "square.gltf", "-o", "out.png"}), 1, "square.gltf");
    EXPECT_FALSE(fs::exists(folder_ / "out.png"));
}

TEST_F(Shot, AccessorThatDoesNotExistFails)
{
    auto document = squareScene(folder_ / "square.gltf");
    document["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 7;
    writeScene(folder_ / "square.gltf", document);
    expectOneLine(run({"shot", "square.gltf", "-o", "out.png"}), 1, "square.gltf");
}

TEST_F(Shot, MissingBufferFails)
{
    writeScene(folder_ / "square.gltf", squareScene(folder_ / "square.gltf"));
    fs::remove(folder_ / "square.bin");
    expectOneLine(run({"shot", "square.gltf", "-o", "out.png"}), 1, "square.bin");
}

TEST_F(Shot, UnknownCameraAndFormatFail)
{
    writeScene(folder_ / "square.gltf", squareScene(folder_ / "square.gltf"));
    expectOneLine(run({"shot", "square.gltf", "--camera", "backstage", "-o", "out.png"}), 1, "backstage");
    expectOneLine(run({"shot", "square.gltf", "-o", "out.docx"}), 1, "out.docx");
}

TEST_F(Shot, QuickWaitsForNoBakeAndSaysSo)
{
    writeScene(folder_ / "square.gltf", squareScene(folder_ / "square.gltf"));
    const auto shoot = [&](const char* file, const std::vector<std::string>& more) {
        // From so far that coarser levels are seen.
        std::vector<std::string> arguments{"shot",   "square.gltf", "--eye", "0,0,20",
                                           "--size", "64x48",       "-o",    file};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const Outcome outcome = run(arguments);
        EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
        return outcome.err;
    };
    const std::string said = shoot("quick.png", {"--quick"});
    EXPECT_NE(said.find("square.gltf: 1 of 1 materials are not baked: --quick"), std::string::npos) << said;
    EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 1) << said;
    EXPECT_NE(shoot("baked.png", {}).find("1 of 1 materials baked"), std::string::npos);
    EXPECT_EQ(shoot("known.png", {"--quick"}), ""); // from the cache
    EXPECT_EQ(readText(folder_ / "known.png"), readText(folder_ / "baked.png"));
    EXPECT_TRUE(readText(folder_ / "quick.png") != readText(folder_ / "baked.png"));
}

TEST_F(Shot, WhatIsNoEnvironmentFails)
{
    writeScene(folder_ / "square.gltf", squareScene(folder_ / "square.gltf"));
    const auto shoot = [&](const char* file) {
        return run({"shot", "square.gltf", "-o", "out.png", "--size", "32x18", "--environment", file});
    };
    expectOneLine(shoot("nowhere.hdr"), 1, "nowhere.hdr");
    expectOneLine(shoot("sky.jpg"), 1, "sky.jpg");
    writeText(folder_ / "poem.hdr", "Roses are red, this is no sky.\n");
    expectOneLine(shoot("poem.hdr"), 1, "poem.hdr");
    writeText(folder_ / "huge.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 16000 +X 32000\n");
    expectOneLine(shoot("huge.hdr"), 1, "huge.hdr");
    writeImage(folder_ / "one.exr", Image(1, 1, 3));
    expectOneLine(shoot("one.exr"), 1, "one.exr");
    Image dark(8, 4, 3);
    dark.pixels[5] = -1.0f;
    writeImage(folder_ / "dark.exr", dark);
    expectOneLine(shoot("dark.exr"), 1, "dark.exr");
    EXPECT_FALSE(fs::exists(folder_ / "out.png"));
    writeImage(folder_ / "black.exr", Image(8, 4, 3));
    EXPECT_EQ(shoot("black.exr").exitCode, 0);
}

TEST_F(Shot, UsageErrorsExitWithTwo)
{
    expectOneLine(run({"shot", "a.gltf", "--frobnicate", "-o", "out.png"}), 2, "--frobnicate");
    expectOneLine(run({"shot", "a.gltf", "--size", "big", "-o", "out.png"}), 2, "--size");
    expectOneLine(run({"shot", "a.gltf", "--shading", "magic", "-o", "out.png"}), 2, "--shading");
    expectOneLine(run({"shot", "a.gltf"}), 2, "--output");
    expectOneLine(run({"shot", "-o", "out.png"}), 2, "scene");
}

TEST_F(Shot, TwoIdenticalShotsAreTheSameBytes)
{
    writeScene(folder_ / "square.gltf", squareScene(folder_ / "square.gltf"));
    for (const std::string shading : {"tsl", "forward", "reference"}) {
        const auto shoot = [&](const std::string& out) {
            const Outcome outcome = run({"shot", "square.gltf", "--size", "160x90", "--shading", shading,
                                         "--samples", "4", "-o", out});
            EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
            EXPECT_NE(outcome.out.find(out), std::string::npos);
            return readText(folder_ / out);
        };
        const std::string first = shoot(shading + "-1.png");
        ASSERT_FALSE(first.empty());
        EXPECT_TRUE(first == shoot(shading + "-2.png")) << shading;
        const Image image = readImage(folder_ / (shading + "-1.png"));
        EXPECT_EQ(image.width, 160);
        EXPECT_EQ(image.height, 90);
        const auto [darkest, brightest] = std::minmax_element(image.pixels.begin(), image.pixels.end());
        EXPECT_GT(*brightest - *darkest, 0.1f) << "nothing was drawn";
    }
}

TEST_F(Shot, ExrHoldsRadiance)
{
    writeScene(folder_ / "square.gltf", squareScene(folder_ / "square.gltf"));
    const Outcome outcome = run({"shot", "square.gltf", "--size", "64x64", "-o", "out.exr"});
    ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
    const Image image = readImage(folder_ / "out.exr");
    EXPECT_EQ(image.width, 64);
    EXPECT_GE(image.channels, 3);
}

TEST_F(Shot, FramesAlongAPath)
{
    writeScene(folder_ / "square.gltf", squareScene(folder_ / "square.gltf"));
    const Outcome outcome = run({"shot", "square.gltf", "--size", "64x48", "--frames", "3", "--path", "orbit",
                                 "--step", "10", "--stats", "s.json", "-o", "f_%04d.png"});
    ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
    EXPECT_NE(outcome.out.find("3 frames (orbit)"), std::string::npos) << outcome.out;
    for (const char* file : {"f_0000.png", "f_0001.png", "f_0002.png"})
        EXPECT_TRUE(fs::exists(folder_ / file)) << file;
    EXPECT_FALSE(fs::exists(folder_ / "f_0003.png"));
    EXPECT_FALSE(readText(folder_ / "f_0000.png") == readText(folder_ / "f_0002.png"));
    const auto stats = nlohmann::json::parse(readText(folder_ / "s.json"));
    EXPECT_EQ(stats["frames"].size(), 3u);
    EXPECT_EQ(stats["options"]["path"], "orbit");
}

TEST_F(Shot, AMorphingSquareIsShownAtItsTime)
{
    auto document = squareScene(folder_ / "square.gltf");
    // Its positions again: weight 1 makes it twice as large. Keys and weights are among the numbers of the
    // file.
    document["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", 0}}};
    document["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", 20}, {"byteLength", 8}});
    document["accessors"].push_back(
        {{"bufferView", 3}, {"componentType", 5126}, {"count", 2}, {"type", "SCALAR"}});
    document["accessors"].push_back({{"componentType", 5126}, {"count", 2}, {"type", "SCALAR"}});
    document["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", 12}, {"byteLength", 4}});
    document["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", 80}, {"byteLength", 4}});
    document["accessors"][4]["sparse"] = {
        {"count", 1},
        {"indices", {{"bufferView", 5}, {"byteOffset", 2}, {"componentType", 5123}}},
        {"values", {{"bufferView", 4}}}};
    document["animations"] = {
        {{"samplers", {{{"input", 3}, {"output", 4}}}},
         {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}}}}}};
    writeScene(folder_ / "square.gltf", document);
    const auto shoot = [&](const char* seconds) {
        const std::string out = std::string(seconds) + ".png";
        const Outcome outcome = run({"shot", "square.gltf", "--size", "64x48", "--eye", "0,0,8", "--target",
                                     "0,0,0", "--time", seconds, "-o", out});
        EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
        return readText(folder_ / out);
    };
    const std::string small = shoot("0");
    EXPECT_TRUE(small == shoot("0"));
    EXPECT_FALSE(small == shoot("0.5"));
    document["accessors"][4]["count"] = 3;
    writeScene(folder_ / "square.gltf", document);
    expectOneLine(run({"shot", "square.gltf", "-o", "out.png"}), 1, "square.gltf");
}

TEST_F(Shot, WithoutANumberOnlyTheLastFrameIsWritten)
{
    writeScene(folder_ / "square.gltf", squareScene(folder_ / "square.gltf"));
    const std::vector<std::string> start{"shot",    "square.gltf", "--size", "64x48",  "--shading",
                                         "forward", "--path",      "dolly",  "--step", "20"};
    const auto shoot = [&](std::vector<std::string> more) {
        std::vector<std::string> arguments = start;
        arguments.insert(arguments.end(), more.begin(), more.end());
        const Outcome outcome = run(arguments);
        EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
    };
    shoot({"--frames", "2", "-o", "last.png"});
    shoot({"--frames", "2", "-o", "%d.png"});
    EXPECT_TRUE(readText(folder_ / "last.png") == readText(folder_ / "1.png"));
    shoot({"-o", "100%.png"}); // one frame: a name like any other
    EXPECT_TRUE(readText(folder_ / "100%.png") == readText(folder_ / "0.png"));
}

TEST_F(Shot, WrongPathsFail)
{
    writeScene(folder_ / "square.gltf", squareScene(folder_ / "square.gltf"));
    for (const char* name : {"%d_%d.png", "%4d.png", "%s.png"})
        expectOneLine(run({"shot", "square.gltf", "--frames", "2", "-o", name}), 1, "%04d");
    expectOneLine(run({"shot", "square.gltf", "--frames", "0", "-o", "a.png"}), 2, "--frames");
    expectOneLine(run({"shot", "square.gltf", "--path", "loop", "-o", "a.png"}), 2, "--path");
    expectOneLine(run({"shot", "square.gltf", "--path", "dolly", "--step", "100", "-o", "a.png"}), 2,
                  "--step");
    expectOneLine(run({"shot", "square.gltf", "--lights", "0", "-o", "a.png"}), 2, "--lights");
    expectOneLine(run({"shot", "square.gltf", "-o", "a.png", "--stats", "no/s.json"}), 1, "no/s.json");
}

TEST_F(Shot, ABudgetOutOfReachIsReportedOnceAndCounted)
{
    writeScene(folder_ / "square.gltf", squareScene(folder_ / "square.gltf"));
    const Outcome outcome = run({"shot", "square.gltf", "--size", "64x48", "--frames", "100", "--path",
                                 "orbit", "--budget-ms", "0.1", "--stats", "s.json", "-o", "a.png"});
    ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
    const size_t said = outcome.err.find("out of reach");
    ASSERT_NE(said, std::string::npos) << outcome.err;
    EXPECT_EQ(outcome.err.find("out of reach", said + 1), std::string::npos) << outcome.err;
    const auto stats = nlohmann::json::parse(readText(folder_ / "s.json"));
    EXPECT_EQ(stats["summary"]["missed"], 100);
    EXPECT_EQ(stats["frames"].front()["render_scale"], 1.0);
    EXPECT_EQ(stats["frames"].back()["render_scale"], 0.4375);
    EXPECT_TRUE(stats["frames"].back()["lumel_budget"].is_number());
    expectOneLine(run({"shot", "square.gltf", "--budget-ms", "0", "-o", "a.png"}), 2, "--budget-ms");
    expectOneLine(run({"shot", "square.gltf", "--budget-ms", "9", "--shading", "reference", "-o", "a.png"}),
                  1, "--budget-ms");
}

TEST_F(Shot, LightsReplaceTheScenes)
{
    writeScene(folder_ / "square.gltf", squareScene(folder_ / "square.gltf"));
    for (const std::string count : {"1", "64"}) {
        const Outcome outcome =
            run({"shot", "square.gltf", "--size", "64x48", "--lights", count, "-o", count + ".png"});
        ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
        const Image image = readImage(folder_ / (count + ".png"));
        EXPECT_GT(*std::max_element(image.pixels.begin(), image.pixels.end()), 0.2f) << count;
    }
    EXPECT_FALSE(readText(folder_ / "1.png") == readText(folder_ / "64.png"));
}

class Help : public Program {};

TEST_F(Help, ListsTheCommandsOnStdout)
{
    for (const char* way : {"help", "--help"}) {
        const Outcome outcome = run({way});
        EXPECT_EQ(outcome.exitCode, 0);
        EXPECT_EQ(outcome.err, "");
        for (const char* command : {"bake", "shot", "compare"})
            EXPECT_NE(outcome.out.find(command), std::string::npos) << way << " lacks " << command;
    }
    const Outcome shot = run({"shot", "--help"});
    EXPECT_EQ(shot.exitCode, 0);
    EXPECT_NE(shot.out.find("--shading"), std::string::npos);
}

TEST_F(Help, OfACommandIsTheSameBothWays)
{
    for (const char* command : {"bake", "shot", "view", "compare", "bench", "help"}) {
        const Outcome help = run({"help", command});
        EXPECT_EQ(help.exitCode, 0);
        EXPECT_EQ(help.out, run({command, "--help"}).out) << command;
    }
    expectOneLine(run({"help", "frobnicate"}), 2, "frobnicate");
}

TEST_F(Help, CommandReferenceIsUpToDate)
{
    const Outcome outcome = run({"help", "--markdown"});
    EXPECT_EQ(outcome.exitCode, 0);
    EXPECT_EQ(outcome.out, readText(LUMEL_COMMANDS))
        << "run: build/lumel help --markdown > engine/app/README.md";
}

TEST_F(Help, NoOrUnknownCommandIsAUsageError)
{
    EXPECT_EQ(run({}).exitCode, 2);
    const Outcome outcome = run({"frobnicate"});
    expectOneLine(outcome, 2, "lumel");
}

class Compare : public Program {};

TEST_F(Compare, TellsEqualFromDifferent)
{
    writeHeightMap(folder_ / "a.png", 40, 30);
    fs::copy_file(folder_ / "a.png", folder_ / "same.png");
    writeHeightMap(folder_ / "wide.png", 50, 30);
    Image shifted = readImage(folder_ / "a.png");
    for (float& value : shifted.pixels)
        value = std::min(1.0f, value + 0.2f);
    writeImage(folder_ / "b.png", shifted);

    EXPECT_EQ(run({"compare", "a.png", "same.png", "--psnr-min", "90"}).exitCode, 0);
    const Outcome different = run({"compare", "a.png", "b.png", "-o", "diff.png"});
    EXPECT_EQ(different.exitCode, 0) << different.err;
    EXPECT_NE(different.out.find("psnr"), std::string::npos);
    EXPECT_TRUE(fs::exists(folder_ / "diff.png"));
    EXPECT_EQ(run({"compare", "a.png", "b.png", "--psnr-min", "30"}).exitCode, 1);
    expectOneLine(run({"compare", "a.png", "wide.png"}), 1, "size");
    expectOneLine(run({"compare", "a.png", "nowhere.png"}), 1, "nowhere.png");
}

} // namespace
} // namespace lumel::cli
