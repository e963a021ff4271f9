#include "core/file.h"
#include "inputs.h"
#include "program.h"
#include <algorithm>
#include <chrono>
#include <csignal>
#include <thread>

namespace lumel::cli {
namespace {

namespace fs = std::filesystem;

class Manifest : public Program {
protected:
    // Height maps in maps/, the manifest beside them.
    void SetUp() override
    {
        Program::SetUp();
        fs::create_directory(folder_ / "maps");
        writeHeightMap(folder_ / "maps" / "a.png", 32, 32);
        writeHeightMap(folder_ / "maps" / "b.png", 24, 40);
    }
    Outcome bakeText(const std::string& text)
    {
        writeText(folder_ / "maps" / "list.json", text);
        return run({"bake", "--manifest", "maps/list.json"});
    }
    Outcome bake(const nlohmann::json& list) { return bakeText(list.dump()); }
    static nlohmann::json entry(const std::string& height, const std::string& output)
    {
        return {{"height", height}, {"height-scale", 0.02}, {"output", output}};
    }
};

size_t lines(const std::string& text)
{
    return size_t(std::count(text.begin(), text.end(), '\n'));
}

TEST_F(Manifest, BakesThenSkipsThenBakesWhatChanged)
{
    nlohmann::json list = nlohmann::json::array({entry("a.png", "a.exr"), entry("b.png", "b.exr")});
    list[1]["specular"] = {1.0, 0.8, 0.3};
    list[1]["normal-green"] = "down";
    Outcome outcome = bake(list);
    ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
    EXPECT_EQ(lines(outcome.out), 2u) << outcome.out;
    EXPECT_NE(outcome.out.find("maps/a.exr: baked"), std::string::npos) << outcome.out;
    EXPECT_TRUE(fs::exists(folder_ / "maps" / "b.exr"));

    const std::string before = readText(folder_ / "maps" / "a.exr");
    outcome = bake(list);
    EXPECT_EQ(outcome.exitCode, 0);
    EXPECT_EQ(outcome.out, "maps/a.exr: up to date\nmaps/b.exr: up to date\n");
    EXPECT_EQ(readText(folder_ / "maps" / "a.exr"), before);

    list[0]["power"] = 77;
    list[1]["float"] = true;
    outcome = bake(list);
    EXPECT_EQ(outcome.exitCode, 0);
    EXPECT_EQ(outcome.out.find("up to date"), std::string::npos) << outcome.out;
    EXPECT_NE(readText(folder_ / "maps" / "a.exr"), before);

    writeHeightMap(folder_ / "maps" / "b.png", 26, 40); // another input
    writeText(folder_ / "maps" / "a.exr", "no picture");
    outcome = bake(list);
    EXPECT_EQ(outcome.exitCode, 0);
    EXPECT_EQ(outcome.out.find("up to date"), std::string::npos) << outcome.out;
}

TEST_F(Manifest, GoesOnAfterAFailureAndNamesIt)
{
    writeText(folder_ / "maps" / "empty.png", "");
    const Outcome outcome =
        bake(nlohmann::json::array({entry("empty.png", "x.exr"), entry("a.png", "a.exr"),
                                    entry("nowhere.png", "y.exr"), entry("b.png", "b.exr")}));
    EXPECT_EQ(outcome.exitCode, 1);
    EXPECT_EQ(outcome.err, "lumel: maps/list.json: 2 of 4 maps failed: maps/x.exr, maps/y.exr\n");
    EXPECT_EQ(lines(outcome.out), 4u);
    EXPECT_NE(outcome.out.find("maps/x.exr: failed: maps/empty.png: empty file"), std::string::npos)
        << outcome.out;
    EXPECT_TRUE(fs::exists(folder_ / "maps" / "a.exr"));
    EXPECT_TRUE(fs::exists(folder_ / "maps" / "b.exr"));
    EXPECT_FALSE(fs::exists(folder_ / "maps" / "x.exr"));
}

TEST_F(Manifest, RefusesToWriteAFileTwice)
{
    const Outcome outcome = bake(
        nlohmann::json::array({entry("a.png", "a.exr"), entry("b.png", "b.exr"), entry("b.png", "./a.exr")}));
    EXPECT_EQ(outcome.exitCode, 1);
    EXPECT_NE(outcome.out.find("entry 3 writes"), std::string::npos) << outcome.out;
    EXPECT_NE(outcome.out.find("like entry 1"), std::string::npos) << outcome.out;
    EXPECT_EQ(bake(nlohmann::json::array({entry("a.png", "a.exr")})).out, "maps/a.exr: up to date\n");
}

TEST_F(Manifest, WritesReports)
{
    nlohmann::json list = nlohmann::json::array({entry("a.png", "a.exr")});
    list[0]["report"] = {"a.json", "a.html"};
    ASSERT_EQ(bake(list).exitCode, 0);
    const auto report = nlohmann::json::parse(readText(folder_ / "maps" / "a.json"));
    EXPECT_EQ(report["map"], "a.exr");
    EXPECT_GT(report["peak_mib"], 1.0);
    EXPECT_EQ(readText(folder_ / "maps" / "a.html").find("<!doctype html>"), 0u);
    fs::remove(folder_ / "maps" / "a.html");
    const Outcome again = bake(list);
    EXPECT_EQ(again.out.find("up to date"), std::string::npos) << "a report was missing";
    EXPECT_TRUE(fs::exists(folder_ / "maps" / "a.html"));
}

TEST_F(Manifest, MistakesAreOneLine)
{
    expectOneLine(bakeText("[{\"height\": \n \"a.png\",,}]"), 1, "list.json: not a JSON list");
    expectOneLine(bake(nlohmann::json::object({{"height", "a.png"}})), 1, "list.json: not a JSON list");
    auto unknown = entry("b.png", "b.exr"), wrong = entry("b.png", "c.exr");
    unknown["hieght"] = 1;
    wrong["power"] = nlohmann::json::object();
    const Outcome outcome = bake(nlohmann::json::array({unknown, wrong, 7}));
    EXPECT_EQ(outcome.exitCode, 1);
    EXPECT_EQ(outcome.err, "lumel: maps/list.json: 3 of 3 maps failed: maps/b.exr, maps/c.exr, entry 3\n");
    EXPECT_NE(outcome.out.find("maps/b.exr: failed: option 'hieght' is unknown"), std::string::npos)
        << outcome.out;
    EXPECT_NE(outcome.out.find("maps/c.exr: failed: option 'power' is malformed"), std::string::npos)
        << outcome.out;
    EXPECT_EQ(lines(outcome.out), 3u);
    expectOneLine(run({"bake", "--manifest", "none.json"}), 1, "none.json");
    expectOneLine(run({"bake", "--manifest", "maps/list.json", "--power", "3"}), 2, "--power");
}

// Four processes on one folder, one of them killed and run again.
TEST_F(Manifest, ShardsShareAFolder)
{
    nlohmann::json list = nlohmann::json::array();
    for (int i = 0; i < 12; ++i) {
        list.push_back(entry("a.png", std::to_string(i) + ".exr"));
        list.back()["power"] = 20 + i;
    }
    writeHeightMap(folder_ / "maps" / "a.png", 256, 256);
    writeText(folder_ / "maps" / "list.json", list.dump());
    const auto shard = [](int i) {
        return std::vector<std::string>{
            "bake", "--manifest", "maps/list.json", "--shard", std::to_string(i) + "/4", "--threads", "1"};
    };
    std::vector<pid_t> processes;
    for (int i = 1; i <= 4; ++i)
        processes.push_back(start(shard(i)));
    while (!fs::exists(folder_ / "maps" / "1.exr") && kill(processes[1], 0) == 0)
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    kill(processes[1], SIGKILL);
    for (int i = 0; i < 4; ++i)
        EXPECT_EQ(finish(processes[size_t(i)]).exitCode, i == 1 ? -1 : 0);
    const std::string mark = processMark(), host = mark.substr(mark.find('-'));
    writeText(folder_ / "maps" / fmt::format(".5.4194305{}.exr", host), "what a killed process leaves");
    fs::remove(folder_ / "maps" / "5.exr");
    const Outcome again = run(shard(2));
    EXPECT_EQ(again.exitCode, 0) << again.err;
    EXPECT_NE(again.out.find("maps/1.exr: up to date"), std::string::npos) << again.out;
    EXPECT_EQ(lines(again.out), 3u);
    const Outcome whole = run({"bake", "--manifest", "maps/list.json"});
    for (int i = 0; i < 12; ++i)
        EXPECT_NE(whole.out.find("maps/" + std::to_string(i) + ".exr: up to date"), std::string::npos);
    for (const auto& file : fs::directory_iterator(folder_ / "maps"))
        EXPECT_NE(file.path().filename().string()[0], '.') << file.path();
}

// By mistake: the work is done twice, and no one takes the other's temporary file away.
TEST_F(Manifest, OneShardMayRunTwiceAtOnce)
{
    nlohmann::json list = nlohmann::json::array();
    for (int i = 0; i < 6; ++i) {
        list.push_back(entry("a.png", std::to_string(i) + ".exr"));
        list.back()["power"] = 20 + i;
    }
    writeHeightMap(folder_ / "maps" / "a.png", 64, 64);
    writeText(folder_ / "maps" / "list.json", list.dump());
    for (int round = 0; round < 4; ++round) {
        std::vector<pid_t> processes;
        for (int i = 0; i < 4; ++i)
            processes.push_back(start({"bake", "--manifest", "maps/list.json", "--threads", "1"}));
        for (const pid_t process : processes) {
            const Outcome outcome = finish(process);
            EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
        }
        for (int i = 0; i < 6; ++i)
            EXPECT_TRUE(fs::remove(folder_ / "maps" / fmt::format("{}.exr", i)));
    }
    for (const auto& file : fs::directory_iterator(folder_ / "maps"))
        EXPECT_NE(file.path().filename().string()[0], '.') << file.path();
}

TEST_F(Manifest, ShardsNeverWriteTheSameFile)
{
    const auto list =
        nlohmann::json::array({entry("a.png", "a.exr"), entry("b.png", "b.exr"), entry("b.png", "./a.exr")});
    writeText(folder_ / "maps" / "list.json", list.dump());
    EXPECT_EQ(run({"bake", "--manifest", "maps/list.json", "--shard", "1/3"}).exitCode, 0);
    const Outcome third = run({"bake", "--manifest", "maps/list.json", "--shard", "3/3"});
    EXPECT_EQ(third.exitCode, 1);
    EXPECT_NE(third.out.find("like entry 1"), std::string::npos) << third.out;
    for (const char* wrong : {"0/3", "4/3", "1", "x/2", "1/", "1/2/3"})
        expectOneLine(run({"bake", "--manifest", "maps/list.json", "--shard", wrong}), 2, "--shard");
    expectOneLine(run({"bake", "--height", "maps/a.png", "-o", "a.exr", "--shard", "1/2"}), 2, "--shard");
}

class ReportOption : public Program {};

TEST_F(ReportOption, WritesWhatItsEndingSays)
{
    writeHeightMap(folder_ / "h.png", 32, 32);
    const std::vector<std::string> bake{"bake",    "--height", "h.png",    "--height-scale", "0.02",    "-o",
                                        "out.exr", "--report", "out.json", "--report",       "out.html"};
    const Outcome outcome = run(bake);
    ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
    EXPECT_EQ(nlohmann::json::parse(readText(folder_ / "out.json"))["levels"].size(), 5u);
    EXPECT_TRUE(fs::exists(folder_ / "out.html"));
    expectOneLine(run({"bake", "--height", "h.png", "-o", "out.exr", "--report", "out.pdf"}), 2, "out.pdf");
}

} // namespace
} // namespace lumel::cli
