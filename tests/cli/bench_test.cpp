#include "core/image.h"
#include "inputs.h"
#include "program.h"
#include "schema.h"
#include <algorithm>
#include <cstring>
#include <regex>

namespace lumel::cli {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class Bench : public Program {
protected:
    void SetUp() override
    {
        Program::SetUp();
        writeScene(folder_ / "square.gltf", squareScene(folder_ / "square.gltf"));
    }
    // On a tiny picture of the square; fails the test unless it exits with 0.
    Outcome bench(std::vector<std::string> more, const std::string& scene = "square.gltf")
    {
        std::vector<std::string> arguments{"bench", scene, "--warmup", "1", "--round", "2"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const Outcome outcome = run(arguments);
        EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
        return outcome;
    }
    json readJson(const std::string& name) { return json::parse(readText(folder_ / name)); }

    // The square with a camera and a lantern on a string of keys: 0 to 2 s, 0.6 m up.
    void writeMovingScene()
    {
        json scene = squareScene(folder_ / "moving.gltf");
        scene["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.8}, {"znear", 0.1}}}}};
        scene["nodes"].push_back({{"name", "flight"}, {"camera", 0}, {"translation", {0, 0, 3}}});
        scene["nodes"].push_back({{"name", "fixed"}, {"camera", 0}, {"translation", {0, 0, 3}}});
        scene["scenes"][0]["nodes"] = {0, 1, 2};
        addMotion(scene, folder_ / "moving.gltf", 1, {0, 0, 3}, {0, 0.6f, 3});
        writeScene(folder_ / "moving.gltf", scene);
    }
};

TEST_F(Bench, EachCombinationIsARunOfTheDocumentedSchema)
{
    const Outcome outcome = bench({"--shading", "tsl,forward-average,forward-4", "--size", "32x24,48x36",
                                   "--lights", "1,3", "--frames", "3", "--json", "b.json"});
    const json document = readJson("b.json");
    EXPECT_EQ(document.at("schema"), 1);
    ASSERT_EQ(document.at("runs").size(), 12u);
    std::set<std::string> names;
    for (const json& run : document.at("runs")) {
        expectRunOfSchema(run);
        EXPECT_EQ(run.at("frames").size(), 3u) << "warm-up is left out";
        names.insert(run.at("shading").get<std::string>() + run.at("size").dump() +
                     run.at("options").at("lights").get<std::string>());
        if (run.at("shading") == "forward-average") {
            EXPECT_EQ(run.at("filter"), "average");
        }
        if (run.at("shading") == "forward-4") {
            EXPECT_EQ(run.at("options").at("samples"), "4");
        }
    }
    EXPECT_EQ(names.size(), 12u);
    EXPECT_EQ(std::count(outcome.out.begin(), outcome.out.end(), '\n'), 14) << outcome.out;
}

TEST_F(Bench, SteadyFramesWaitForNoneButTheRings)
{
    const auto waits = [&](const std::string& residency, const char* what) {
        bench({"--size", "32x24", "--frames", "100", "--residency", residency, "--json", "w.json"});
        const json document = readJson("w.json");
        int sum = 0;
        for (const json& frame : document.at("runs").at(0).at("frames"))
            sum += frame.at(what).get<int>();
        return sum;
    };
    EXPECT_EQ(waits("latest", "host_waits"), 0);
    EXPECT_GT(waits("latest", "ring_waits"), 90);
    EXPECT_LE(waits("latest", "ring_waits"), 100) << "one a frame";
    EXPECT_EQ(waits("exact", "host_waits"), 200);
    EXPECT_EQ(waits("exact", "ring_waits"), 0);
}

TEST_F(Bench, ForwardAnisoAloneIsAnisotropic)
{
    bench({"--shading", "forward,forward-aniso,forward-aniso-average", "--size", "32x24", "--frames", "1",
           "--json", "a.json"});
    bench({"--shading", "forward-aniso,tsl", "--forward-anisotropy", "4", "--size", "32x24", "--frames", "1",
           "--json", "b.json"});
    const json a = readJson("a.json").at("runs"), b = readJson("b.json").at("runs");
    const auto anisotropy = [](const json& run) { return run["options"]["forward-anisotropy"]; };
    EXPECT_EQ(anisotropy(a[0]), "1");
    EXPECT_EQ(anisotropy(a[1]), "8");
    EXPECT_EQ(anisotropy(a[2]), "8");
    EXPECT_EQ(a[2]["filter"], "average");
    EXPECT_EQ(anisotropy(b[0]), "4");
    EXPECT_EQ(anisotropy(b[1]), "1");
}

TEST_F(Bench, ReadmeNamesEveryField)
{
    bench({"--size", "16x16", "--frames", "2", "--floors", "--shading", "tsl,forward", "--json", "b.json"});
    std::set<std::string> words;
    const std::string readme = readText(LUMEL_README);
    const std::regex code("`([^`\n]+)`"), word("[a-z0-9_]+");
    for (std::sregex_iterator span(readme.begin(), readme.end(), code), end; span != end; ++span) {
        const std::string text = (*span)[1];
        for (std::sregex_iterator match(text.begin(), text.end(), word); match != end; ++match)
            words.insert(match->str());
    }
    for (const std::string& name : fieldNames(readJson("b.json")))
        EXPECT_TRUE(words.contains(name)) << "README does not explain " << name;
}

TEST_F(Bench, ShotStatisticsAreOfTheSameSchema)
{
    ASSERT_EQ(
        run({"shot", "square.gltf", "--size", "32x24", "--frames", "2", "--stats", "s.json", "-o", "a.png"})
            .exitCode,
        0);
    expectRunOfSchema(readJson("s.json"));
    const Outcome same = run({"bench", "--compare", "s.json", "s.json", "--limit", "1.01"});
    EXPECT_EQ(same.exitCode, 0) << same.err;
}

TEST_F(Bench, ErrorAndFlickerAreMeasuredWhereAsked)
{
    bench({"--size", "48x36", "--frames", "5", "--shading", "forward-8,forward", "--samples", "8",
           "--error-every", "2", "--json", "e.json"});
    const json document = readJson("e.json"); // which must outlive the loop
    for (const json& run : document.at("runs")) {
        for (int i = 0; i < 5; ++i)
            EXPECT_EQ(run["frames"][size_t(i)]["error_rmse"].is_null(), i % 2 == 1) << i;
        EXPECT_TRUE(run["summary"]["flicker_rmse"].is_null());
    }
    bench({"--size", "48x36", "--frames", "5", "--shading", "forward-8,forward", "--samples", "8",
           "--flicker", "--path", "pan", "--step", "1", "--json", "f.json"});
    const json runs = readJson("f.json").at("runs");
    EXPECT_EQ(runs[0]["summary"]["error_rmse"], 0.0) << "with as many samples it is the reference";
    EXPECT_EQ(runs[0]["summary"]["flicker_rmse"], 0.0);
    EXPECT_GT(runs[1]["summary"]["error_rmse"], 0.0);
    EXPECT_GT(runs[1]["summary"]["flicker_rmse"], 0.0);
    EXPECT_GT(runs[1]["summary"]["change_rmse"], 0.0);
    EXPECT_TRUE(runs[1]["frames"][0]["flicker_rmse"].is_null()) << "nothing to compare the first with";
    for (size_t i = 1; i < 5; ++i)
        EXPECT_FALSE(runs[1]["frames"][i]["flicker_rmse"].is_null()) << "also across turns: " << i;
}

TEST_F(Bench, FloorsAreOfTextureSpaceAndForwardShading)
{
    const Outcome outcome = bench({"--size", "48x36", "--frames", "3", "--shading", "tsl,forward,forward-2",
                                   "--floors", "--json", "f.json"});
    const json runs = readJson("f.json").at("runs");
    ASSERT_EQ(runs.size(), 3u);
    expectRunOfSchema(runs[0], true);
    expectRunOfSchema(runs[1], true);
    expectRunOfSchema(runs[2], false);
    const auto ratio = [&](size_t run, const char* pass) {
        return runs[run].at("floors").at("passes").at(pass).at("ratio");
    };
    for (const char* pass : {"feedback", "light", "draw"})
        EXPECT_GT(ratio(0, pass), 0.0) << pass;
    EXPECT_TRUE(ratio(0, "plan").is_null());
    EXPECT_GT(ratio(1, "draw"), 0.0);
    EXPECT_TRUE(ratio(1, "light").is_null());
    EXPECT_NE(outcome.out.find("feedback + plan + lower"), std::string::npos) << outcome.out;
}

TEST_F(Bench, LoadChangesAtItsFrame)
{
    // A light that moves makes everything be lit again; what stands still is kept. Each of the 16 offsets of
    // the samples may then find a few lumels more that the picture reads.
    ASSERT_EQ(run({"bench", "square.gltf", "--size", "48x36", "--frames", "24", "--warmup", "20", "--path",
                   "still", "--load-lights", "2@0,8@5", "--json", "l.json"})
                  .exitCode,
              0);
    const json load = readJson("l.json").at("runs").at(0);
    EXPECT_EQ(load["options"]["lights"], "2@0,8@5");
    const auto lit = [&](size_t frame) { return int(load["frames"][frame]["lumels"]["lit"]); };
    int more = 0;
    for (size_t i = 0; i < 24; ++i) {
        EXPECT_EQ(i < 5 || i > 20 ? lit(i) : 0, 0) << i;
        more += i > 5 ? lit(i) : 0;
    }
    EXPECT_GT(lit(5), 0);
    EXPECT_LT(more, lit(5) / 4);
}

TEST_F(Bench, CameraFollowsItsAnimation)
{
    writeMovingScene();
    bench({"--size", "48x36", "--frames", "3", "--time-step", "0.5", "--json", "m.json"}, "moving.gltf");
    EXPECT_EQ(readJson("m.json")["runs"][0]["options"]["path"], "animation");
    const auto shoot = [&](std::vector<std::string> more, const std::string& file) {
        std::vector<std::string> arguments{"shot",      "moving.gltf", "--size", "48x36",
                                           "--shading", "forward",     "-o",     file};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const Outcome outcome = run(arguments);
        EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
        return readText(folder_ / file.substr(0, file.find('%'))) + readText(folder_ / "f2.png");
    };
    // Three frames of half a second end where --time 1 begins; the fixed camera sees nothing move.
    shoot({"--path", "animation", "--time-step", "0.5", "--frames", "3"}, "f%d.png");
    shoot({"--time", "1"}, "at1.png");
    shoot({"--time", "0"}, "at0.png");
    shoot({"--time", "1", "--camera", "fixed"}, "fixed.png");
    EXPECT_TRUE(readText(folder_ / "f2.png") == readText(folder_ / "at1.png"));
    EXPECT_TRUE(readText(folder_ / "f0.png") == readText(folder_ / "at0.png"));
    EXPECT_TRUE(readText(folder_ / "fixed.png") == readText(folder_ / "at0.png"));
    EXPECT_FALSE(readText(folder_ / "at1.png") == readText(folder_ / "at0.png"));
    expectOneLine(run({"bench", "moving.gltf", "--camera", "fixed", "--path", "animation"}), 1,
                  "not animated");
}

TEST_F(Bench, WritesCsvAndPlot)
{
    bench({"--size", "32x24", "--frames", "4", "--shading", "tsl,forward", "--csv", "b.csv", "--plot",
           "b.png"});
    const std::string csv = readText(folder_ / "b.csv");
    EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 9) << csv;
    const Image plot = readImage(folder_ / "b.png");
    EXPECT_EQ(plot.width, 1280);
    const auto [darkest, brightest] = std::minmax_element(plot.pixels.begin(), plot.pixels.end());
    EXPECT_GT(*brightest - *darkest, 0.7f) << "no text on it";
}

TEST_F(Bench, CompareJudgesByTheLimit)
{
    bench({"--size", "32x24", "--frames", "4", "--json", "a.json"});
    json slower = readJson("a.json");
    for (json& frame : slower["runs"][0]["frames"])
        frame["ms"] = 1.5 * frame["ms"].get<double>();
    writeText(folder_ / "b.json", slower.dump());
    EXPECT_EQ(run({"bench", "--compare", "a.json", "b.json"}).exitCode, 0);
    EXPECT_EQ(run({"bench", "--compare", "a.json", "b.json", "--limit", "1.6"}).exitCode, 0);
    const Outcome beyond = run({"bench", "--compare", "a.json", "b.json", "--limit", "1.4"});
    EXPECT_EQ(beyond.exitCode, 1);
    EXPECT_NE(beyond.out.find("1.500"), std::string::npos) << beyond.out;
    EXPECT_EQ(run({"bench", "--compare", "b.json", "a.json", "--limit", "1.01"}).exitCode, 0);
}

TEST_F(Bench, AnInstalledProgramFindsItsScenes)
{
    fs::create_directory(folder_ / "bin");
    fs::copy_file(LUMEL_PROGRAM, folder_ / "bin" / "lumel");
    const std::string command = "cd '" + folder_.string() +
                                "' && XDG_CACHE_HOME=cache bin/lumel bench --size 16x16 " +
                                "--warmup 0 --frames 1 --json b.json > cache/out 2>&1";
    EXPECT_NE(std::system(command.c_str()), 0);
    const std::string message = readText(folder_ / "cache" / "out");
    EXPECT_NE(message.find("stress.gltf"), std::string::npos) << message;
    const fs::path scenes = folder_ / "share" / "lumel" / "assets";
    fs::create_directories(scenes / "stress");
    writeScene(scenes / "stress" / "stress.gltf", squareScene(scenes / "stress" / "stress.gltf"));
    EXPECT_EQ(std::system(command.c_str()), 0) << readText(folder_ / "cache" / "out");
    EXPECT_EQ(readJson("b.json")["runs"][0]["scene"], "share/lumel/assets/stress/stress.gltf");
}

TEST_F(Bench, BadMeasurementsFail)
{
    writeText(folder_ / "poem.json", "Roses are red");
    writeText(folder_ / "other.json", "{\"schema\": 1, \"runs\": [{\"scene\": 3}]}");
    for (const char* file : {"poem.json", "other.json", "missing.json"})
        expectOneLine(run({"bench", "--compare", file, file}), 1, file);
}

TEST_F(Bench, WrongUseFails)
{
    for (const char* shading : {"magic", "tsl-16", "forward-16-average", "forward-0", "forward-", "tsl,",
                                "tsl-aniso", "forward-aniso-16", "forward-average-aniso"})
        expectOneLine(run({"bench", "square.gltf", "--shading", shading}), 2, "--shading");
    for (const char* load : {"16", "16@5", "0@0", "4@0,8@0", "4@0,x@9"})
        expectOneLine(run({"bench", "square.gltf", "--load-lights", load}), 2, "--load-lights");
    expectOneLine(run({"bench", "square.gltf", "--size", "32x24,big"}), 2, "--size");
    expectOneLine(run({"bench", "square.gltf", "--lights", "-1"}), 2, "--lights");
    expectOneLine(run({"bench", "square.gltf", "--lights", "1", "--load-lights", "1@0"}), 2, "--load-lights");
    expectOneLine(run({"bench", "--compare", "a.json", "b.json", "--frames", "3"}), 2, "--frames");
    expectOneLine(run({"bench", "nowhere.gltf"}), 1, "nowhere.gltf");
    expectOneLine(run({"bench", "square.gltf", "--plot", "p.jpg"}), 1, "p.jpg");
    expectOneLine(run({"bench", "square.gltf", "--json", "no/where.json"}), 1, "no/where.json");
}

} // namespace
} // namespace lumel::cli
