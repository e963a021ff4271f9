#include "bench/compare_runs.h"
#include "bench/floors.h"
#include "bench/plot.h"
#include "bench/quality.h"
#include "core/error.h"
#include <algorithm>
#include <fstream>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sstream>
#include <unistd.h>

namespace lumel::bench {
namespace {

using nlohmann::json;

// A run of the documented form whose frame i takes first + i ms.
json runJson(const std::string& shading, double firstMs, int count, json options = json::object())
{
    json frames = json::array();
    for (int i = 0; i < count; ++i)
        frames.push_back(
            {{"ms", firstMs + i},
             {"passes", {{"draw", 2.0}, {"light", 1.0 + i}}},
             {"lumels", {{"marked", 1000}, {"lit", 100 * i}, {"derived", 0}, {"kept", 900}, {"pending", 0}}},
             {"pool", {{"used_bytes", 4096}}},
             {"render_scale", 1.0},
             {"error_rmse", nullptr},
             {"flicker_rmse", i == 1 ? json(0.25) : json(nullptr)}});
    return {{"schema", 1},
            {"scene", "models/tea, pot.gltf"},
            {"shading", shading},
            {"filter", "fit"},
            {"size", {640, 480}},
            {"options", std::move(options)},
            {"frames", frames},
            {"summary",
             {{"mean_ms", firstMs},
              {"p50_ms", 1.0},
              {"p95_ms", 2.0},
              {"p99_ms", 3.0},
              {"max_ms", 4.0},
              {"missed", 0},
              {"error_rmse", nullptr},
              {"flicker_rmse", 0.25},
              {"change_rmse", nullptr}}}};
}

json document(std::vector<json> runs)
{
    return {{"schema", 1}, {"runs", std::move(runs)}};
}

struct BenchFiles : testing::Test {
    std::filesystem::path file =
        std::filesystem::temp_directory_path() / ("lumel-bench-" + std::to_string(getpid()));
    ~BenchFiles() override { std::filesystem::remove(file); }

    std::string messageFor(const std::string& text)
    {
        std::ofstream(file) << text;
        try {
            readRuns(file);
        } catch (const Error& e) {
            return e.what();
        }
        return "";
    }
};

TEST_F(BenchFiles, ReadsRunsAndASingleOne)
{
    EXPECT_EQ(messageFor(document({runJson("tsl", 5, 3), runJson("forward", 6, 2)}).dump()), "");
    EXPECT_EQ(readRuns(file).size(), 2u);
    EXPECT_EQ(messageFor(runJson("tsl", 5, 3).dump()), "");
    const std::vector<bench::Run> runs = readRuns(file);
    ASSERT_EQ(runs.size(), 1u);
    EXPECT_EQ(runs[0].name(), "tea, pot tsl 640x480");
    EXPECT_EQ(runs[0].frames.size(), 3u);
    EXPECT_EQ(runs[0].mean(&FrameRecord::lit), 100.0);
    EXPECT_EQ(runs[0].meanPass("light"), 2.0);
    EXPECT_EQ(runs[0].meanPass("feedback"), 0.0);
}

TEST_F(BenchFiles, BadFilesGiveOneLineThatNamesThem)
{
    json noFrames = runJson("tsl", 5, 0), text = runJson("tsl", 5, 2), stopped = runJson("tsl", 0, 2);
    text["frames"][0]["ms"] = "fast";
    for (const std::string& bad :
         {std::string(""), std::string("Roses"), std::string("[1]"), std::string("{}"),
          json{{"schema", 2}, {"runs", json::array()}}.dump(), document({}).dump(),
          document({json::object()}).dump(), document({noFrames}).dump(), document({text}).dump(),
          document({stopped}).dump(), std::string(5000, '['), std::string("{\"schema\":1,\"runs\":7}")}) {
        const std::string message = messageFor(bad);
        EXPECT_EQ(message.rfind(file.string(), 0), 0u) << bad.substr(0, 60);
        EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    }
}

TEST(CompareRuns, PairsByWhatWasMeasured)
{
    const json sixteen = {{"lights", "16"}};
    const auto a = runsOf(
        document({runJson("tsl", 10, 20), runJson("tsl", 10, 20, sixteen), runJson("forward", 40, 20)}));
    const auto b = runsOf(document({runJson("forward", 40, 20), runJson("tsl", 29.5, 20, sixteen)}));
    const auto ratios = compareRuns(a, b);
    ASSERT_EQ(ratios.size(), 2u);
    EXPECT_EQ(ratios[0].name, "tea, pot tsl 640x480 16 lights");
    EXPECT_DOUBLE_EQ(ratios[0].p50.value, (29.5 + 9.0) / (10.0 + 9.0));
    EXPECT_DOUBLE_EQ(ratios[1].p95.value, 1.0);
    EXPECT_DOUBLE_EQ(worstOf(ratios), std::max(ratios[0].p50.value, ratios[0].p95.value));
    EXPECT_THROW(
        compareRuns(runsOf(document({runJson("tsl", 1, 2)})), runsOf(document({runJson("forward", 1, 2)}))),
        Error);
}

TEST(CsvOf, HasALinePerFrameAndAsManyFieldsInEach)
{
    const std::string csv = csvOf(runsOf(document({runJson("tsl", 5, 3), runJson("forward", 6, 2)})));
    std::istringstream lines(csv);
    std::vector<size_t> fields;
    for (std::string line; std::getline(lines, line);) {
        EXPECT_EQ(line.back(), '\r');
        bool quoted = false;
        size_t commas = 0;
        for (char c : line) {
            quoted = quoted != (c == '"');
            commas += c == ',' && !quoted;
        }
        fields.push_back(commas);
    }
    ASSERT_EQ(fields.size(), 6u);
    for (size_t n : fields)
        EXPECT_EQ(n, fields[0]) << "the scene's comma is quoted";
}

TEST(Floors, RatiosAreOfMediansForEachUnit)
{
    std::vector<FloorFrame> frames;
    for (const double lit : {0.0, 100.0, 100.0, 200.0}) // the first lit nothing
        frames.push_back(
            {.ms = 10.0,
             .passMs = {{"light", 1e-6 * 300.0 * lit}, {"draw", 4e-3}, {"plan", 1.0}, {"lower", 0.5}},
             .lit = lit,
             .derived = 0.0,
             .pixels = 50.0,
             .floorNs = {{"bicubic_two_levels", 20.0}}});
    for (size_t i = 1; i < frames.size(); ++i)
        frames[i].floorNs["light"] = 30.0;
    frames[1].passMs["feedback"] = frames[3].passMs["feedback"] = 2.0; // in every second frame
    const json floors = floorsOf(frames);
    const json& light = floors.at("passes").at("light");
    EXPECT_NEAR(light.at("ns"), 300.0, 1e-9);
    EXPECT_NEAR(light.at("ratio"), 10.0, 1e-9);
    EXPECT_NEAR(floors.at("passes").at("draw").at("ratio"), 4.0, 1e-9);
    EXPECT_TRUE(floors.at("passes").at("lower").at("ns").is_null()) << "nothing derived";
    EXPECT_TRUE(floors.at("passes").at("plan").at("ratio").is_null()) << "without a floor";
    EXPECT_EQ(floors.at("passes").at("feedback").at("ms"), 2.0) << "where it ran";
    EXPECT_NEAR(floors.at("overhead_share"), 0.25, 1e-9) << "of all frames";

    json run = runJson("tsl", 5, 2);
    EXPECT_EQ(floorTables(document({run})), "");
    run["floors"] = floors;
    const std::string table = floorTables(document({run}));
    EXPECT_NE(table.find("tea, pot tsl 640x480"), std::string::npos) << table;
    EXPECT_NE(table.find("10.00"), std::string::npos) << table;
}

TEST(Floors, ForwardShadingHasItsOwn)
{
    const json floors = floorsOf({{.ms = 10.0,
                                   .passMs = {{"draw", 9e-3}},
                                   .lit = 0.0,
                                   .derived = 0.0,
                                   .pixels = 30.0,
                                   .floorNs = {{"forward", 100.0}}}});
    EXPECT_NEAR(floors.at("passes").at("draw").at("ratio"), 3.0, 1e-9);
}

TEST(Plot, ShowsEachRunAndTheBudget)
{
    const auto one = runsOf(document({runJson("tsl", 5, 30)}));
    const auto budget = runsOf(document({runJson("tsl", 5, 30, {{"budget-ms", "16"}})}));
    const auto two = runsOf(document({runJson("tsl", 5, 30), runJson("forward", 20, 30)}));
    const Image a = plotRuns(one), b = plotRuns(budget), c = plotRuns(two);
    ASSERT_EQ(a.width, 1280);
    const auto pixelsOf = [](const Image& image, float red, float green, float blue) {
        size_t count = 0;
        for (size_t i = 0; i < image.pixels.size(); i += 3)
            count += std::abs(image.pixels[i] - red) + std::abs(image.pixels[i + 1] - green) +
                         std::abs(image.pixels[i + 2] - blue) <
                     0.1f;
        return count;
    };
    EXPECT_LT(pixelsOf(a, 1.0f, 0.35f, 0.35f), 20u);
    EXPECT_GT(pixelsOf(b, 1.0f, 0.35f, 0.35f), 800u) << "the budget's line runs across";
    EXPECT_LT(pixelsOf(a, 0.34f, 0.71f, 0.91f), 20u);
    EXPECT_GT(pixelsOf(c, 0.34f, 0.71f, 0.91f), 800u) << "the second run's line";
}

TEST(Quality, FlickerIsWhatChangesUnlikeTheReference)
{
    Image black(4, 3, 3), grey(4, 3, 3), white(4, 3, 3);
    std::fill(grey.pixels.begin(), grey.pixels.end(), 0.5f);
    std::fill(white.pixels.begin(), white.pixels.end(), 1.0f);
    EXPECT_DOUBLE_EQ(rmseOf(black, grey), 0.5);
    EXPECT_DOUBLE_EQ(flickerOf(black, grey, grey, white), 0.0) << "wrong, but steady";
    EXPECT_DOUBLE_EQ(flickerOf(black, white, grey, grey), 1.0);
    EXPECT_DOUBLE_EQ(flickerOf(grey, grey, black, white), 1.0) << "stays though it should change";
    Image one = black; // a single channel of a single pixel
    one.pixels[5] = 0.6f;
    EXPECT_NEAR(flickerOf(black, one, black, black), 0.6 / std::sqrt(36.0), 1e-7);
}

} // namespace
} // namespace lumel::bench
