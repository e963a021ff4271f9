#include "inputs.h"
#include "program.h"
#include <algorithm>

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
