#include "baker/report.h"
#include "core/error.h"
#include "core/file.h"
#include "maps.h"
#include <nlohmann/json.hpp>

namespace lumel::baker {
namespace {
using namespace test;
} // namespace

TEST(Report, ComparesTheFitWithEveryClosedForm)
{
    const Maps maps = heightMaps(bumps(32, 32), 0.2f, 120.0f);
    const ReflectanceMips mips = bake(maps, exactly());
    const auto json = nlohmann::json::parse(reportJson(makeReport(maps, exactly(), mips, 1.5)));
    EXPECT_EQ(json["schema"], 2);
    EXPECT_EQ(json["seconds"], 1.5);
    ASSERT_EQ(json["levels"].size(), mips.levels.size() - 1);
    for (const auto& level : json["levels"]) {
        ASSERT_EQ(level["methods"].size(), 7u);
        const auto& fit = level["methods"][0];
        EXPECT_EQ(fit["method"], "fit");
        EXPECT_NEAR(fit["mean"].get<double>(), meanOf(mips.levels[level["level"]], kError), 1e-6);
        for (const auto& other : level["methods"]) {
            const double tolerance = other["method"] == "fit-power" ? 1e-4 : 1e-6; // it is a search, too
            EXPECT_LE(fit["mean"].get<double>(), other["mean"].get<double>() + tolerance) << other["method"];
            EXPECT_LE(other["mean"].get<double>(), other["worst"].get<double>() + 1e-9);
        }
    }
}

TEST(Report, ShowsOneLobeBesideTwo)
{
    const Maps maps = heightMaps(bumps(32, 32), 0.4f, 120.0f);
    Options options;
    options.lobes = LobeCount::automatic;
    const ReflectanceMips mips = bake(maps, options);
    const Report report = makeReport(maps, options, mips, 0.1);
    const auto json = nlohmann::json::parse(reportJson(report));
    for (const auto& level : json["levels"]) {
        ASSERT_EQ(level["methods"].size(), 8u);
        const auto &two = level["methods"][0], &one = level["methods"][1];
        EXPECT_EQ(two["method"], "fit");
        EXPECT_EQ(one["method"], "one lobe");
        EXPECT_LE(two["mean"].get<double>(), one["mean"].get<double>());
        for (const auto* method : {&two, &one})
            EXPECT_NEAR((*method)["measured"]["mean"], (*method)["mean"], 4e-3) << level["level"];
    }
    EXPECT_LT(json["levels"][1]["methods"][0]["mean"], 0.8 * double(json["levels"][1]["methods"][1]["mean"]));
    EXPECT_NE(reportHtml(report).find("one lobe"), std::string::npos);
}

TEST(Report, PageIsSelfContained)
{
    const Maps maps = normalMaps(noiseNormals(32, 32, 0.2f, 6), 60.0f);
    Options options;
    options.reduce = 1;
    const ReflectanceMips mips = bake(maps, options);
    const std::string page = reportHtml(makeReport(maps, options, mips, 0.1));
    EXPECT_NE(page.find("data:image/png;base64,"), std::string::npos);
    EXPECT_EQ(page.find("://"), std::string::npos); // base64 has no colon
    EXPECT_EQ(page.find("<script"), std::string::npos);
    for (const char* word : {"best", "median", "worst", "lean", "toksvig"})
        EXPECT_NE(page.find(word), std::string::npos) << word;
}

TEST(Report, OtherExtensionsAreRefused)
{
    const Maps maps = heightMaps(bumps(4, 4), 0.2f, 120.0f);
    EXPECT_THROW(writeReport("/tmp/report.txt", makeReport(maps, {}, bake(maps, {}), 0.0)), Error);
}
} // namespace lumel::baker
