// The report's numbers against the oracle, and the form of what it writes.
#include "baker/report.h"
#include "baker/report_grid.h"
#include "core/error.h"
#include "maps.h"
#include "oracle.h"
#include <nlohmann/json.hpp>

namespace lumel::baker {
namespace {
using namespace test;

struct Measured {
    Maps maps;
    Options options;
    ReflectanceMips mips;
    Report report;
};

Measured measured(Maps maps, Options options = {})
{
    Measured m{std::move(maps), options, {}, {}};
    m.mips = bake(m.maps, options);
    m.report = makeReport(m.maps, options, m.mips, 1.5);
    m.report.name = "<rock> & \"roll\".exr";
    return m;
}

Maps reportedMap()
{
    return heightMaps(bumps(16, 16), 0.1f, 90.0f);
}

double oracleError(const ReflectanceMips& mips, const ReflectanceMips& stored, size_t level, int x, int y)
{
    const float* t = stored.levels[level].at(x, y);
    return oracleSums(lobesUnder(mips, level, x, y), oracleLobe(t), 300).relativeError(t[kKsR]);
}

// The page without its pictures, whose base64 may spell anything.
std::string textOf(const Report& report)
{
    std::string page = reportHtml(report);
    for (size_t at = page.find("base64,"); at != std::string::npos; at = page.find("base64,", at + 7))
        page.erase(at + 7, page.find('\'', at) - at - 7);
    return page;
}

size_t count(const std::string& text, const std::string& part)
{
    size_t n = 0;
    for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + part.size()))
        ++n;
    return n;
}
} // namespace

TEST(ReportMeasure, FiguresAreTheOracles)
{
    const Measured m = measured(reportedMap());
    ASSERT_EQ(m.report.measured.methods,
              (std::vector<std::string>{"fit", "fit-power", "lean", "toksvig", "average", "height", "flat"}));
    const Method forms[] = {Method::fit,     Method::fitPower, Method::lean, Method::toksvig,
                            Method::average, Method::height,   Method::flat};
    ASSERT_EQ(m.report.measured.levels.size(), 4u);
    const MeasuredLevel& level = m.report.measured.levels[1]; // 4 x 4: every texel is measured
    ASSERT_EQ(level.number, 2);
    ASSERT_EQ(level.sample.size(), 16u);
    for (size_t method = 0; method < m.report.measured.methods.size(); ++method) {
        Options options;
        options.method = forms[method];
        options.bestKs = true;
        const ReflectanceMips stored = bake(m.maps, options);
        double sum = 0.0, worst = 0.0;
        for (int i = 0; i < 16; ++i) {
            const double error = oracleError(m.mips, stored, 2, i % 4, i / 4);
            sum += error;
            worst = std::max(worst, error);
        }
        EXPECT_NEAR(level.figures[method].mean, sum / 16.0, 2e-3 * (1.0 + sum))
            << m.report.measured.methods[method];
        EXPECT_NEAR(level.figures[method].worst, worst, 2e-3 * (1.0 + worst))
            << m.report.measured.methods[method];
        EXPECT_LE(level.figures[method].mean, level.figures[method].p95 + 1e-12);
        EXPECT_LE(level.figures[method].p95, level.figures[method].worst);
    }
}

TEST(ReportMeasure, MeasuresOddSizesAndTexelsOfFineLevels)
{
    // Level 1 has more texels than are measured; the sizes cover fractions of texels.
    for (const Options& options : {exactly(), Options()}) {
        const Measured m = measured(normalMaps(noiseNormals(45, 37, 0.15f, 3), 60.0f), options);
        EXPECT_EQ(m.report.measured.methods.size(), 6u) << "a normal map has no heights to average";
        EXPECT_EQ(m.report.measured.levels[0].sample.size(), size_t(kReportTexels));
        for (const MeasuredLevel& level : m.report.measured.levels) {
            // What the baker stated of the same texels.
            double stated = 0.0;
            for (const int i : level.sample)
                stated += m.mips.levels[size_t(level.number)].at(i % level.width, i / level.width)[kError];
            EXPECT_NEAR(level.figures[0].mean, stated / double(level.sample.size()), 2e-3) << level.number;
            for (size_t method = 1; method < m.report.measured.methods.size(); ++method)
                EXPECT_LE(level.figures[0].mean,
                          level.figures[method].mean + 1e-4 + double(options.precision));
        }
    }
}

TEST(ReportMeasure, BakedClosedFormsAreNamedByTheirKs)
{
    Options lean;
    lean.method = Method::lean;
    const Measured m = measured(reportedMap(), lean);
    EXPECT_EQ(m.report.measured.methods[0], "lean, mean Ks");
    EXPECT_EQ(m.report.measured.methods[2], "lean");
    const auto json = nlohmann::json::parse(reportJson(m.report));
    for (const auto& level : json["levels"]) {
        EXPECT_EQ(level["methods"][0]["ks"], "mean");
        EXPECT_EQ(level["methods"][2]["method"], "lean");
        EXPECT_EQ(level["methods"][2]["ks"], "best");
        EXPECT_GT(level["methods"][0]["measured"]["mean"], level["methods"][2]["measured"]["mean"]);
    }
}

// Diffuse errors against sums over a dense grid of lights, implemented independently.
TEST(ReportMeasure, DiffuseErrorsAreThoseOfBruteForce)
{
    Maps maps = normalMaps(noiseNormals(16, 16, 0.6f, 5), 60.0f);
    maps.diffuse = bumps(16, 16);
    const Measured m = measured(maps);
    const MeasuredLevel& level = m.report.measured.levels[1]; // 4 x 4: every texel is measured
    double sum = 0.0, worst = 0.0;
    for (int i = 0; i < 16; ++i) {
        const float* t = m.mips.levels[2].at(i % 4, i / 4);
        double error = 0.0, energy = 0.0;
        constexpr int kSide = 200; // of cos(theta) and of phi
        for (int a = 0; a < kSide; ++a)
            for (int b = 0; b < kSide; ++b) {
                const double z = (a + 0.5) / kSide, r = std::sqrt(1.0 - z * z),
                             phi = 6.2831853072 * b / kSide;
                const auto matte = [&](const float* texel) {
                    const double nx = texel[kNx], ny = texel[kNy], nz = std::sqrt(1.0 - nx * nx - ny * ny);
                    return texel[kKdG] *
                           std::max(0.0, nx * r * std::cos(phi) + ny * r * std::sin(phi) + nz * z);
                };
                double average = 0.0;
                for (int k = 0; k < 16; ++k)
                    average += matte(m.mips.levels[0].at(i % 4 * 4 + k % 4, i / 4 * 4 + k / 4)) / 16.0;
                error += (matte(t) - average) * (matte(t) - average);
                energy += average * average;
            }
        sum += error / energy;
        worst = std::max(worst, error / energy);
    }
    EXPECT_GT(sum / 16.0, 1e-3) << "these bumps cut light off";
    EXPECT_NEAR(level.diffuse[0].mean, sum / 16.0, 0.02 * sum / 16.0);
    EXPECT_NEAR(level.diffuse[0].worst, worst, 0.02 * worst);
    // Flat maps: the average is one normal's, and exact.
    const Measured flat = measured(normalMaps(constantImage(8, 8, {0.5f, 0.5f, 1.0f}), 50.0f));
    for (const MeasuredLevel& l : flat.report.measured.levels)
        EXPECT_LT(l.diffuse[0].worst, 1e-9);
}

TEST(ReportMeasure, PathsRunDownToTheFit)
{
    const Measured m = measured(reportedMap());
    for (const MeasuredLevel& level : m.report.measured.levels)
        for (const Exhibit& exhibit : level.exhibits) {
            const Landscape& land = exhibit.landscape;
            ASSERT_FALSE(land.path.empty());
            for (size_t i = 1; i < land.path.size(); ++i)
                EXPECT_LT(land.path[i].error, land.path[i - 1].error);
            const StoredLobe& fit = exhibit.texel.lobes.front();
            EXPECT_NEAR(land.path.back().error, fit.error, 0.1 * fit.error + 2e-3) << level.number;
            // The landscape has no point much below the fit.
            const float least = *std::min_element(land.logError.begin(), land.logError.end());
            EXPECT_GT(std::expm1(least), 0.9 * fit.error - 2e-3);
        }
}

TEST(ReportMeasure, JsonHasTheDocumentedFields)
{
    const Measured m = measured(reportedMap());
    const auto json = nlohmann::json::parse(reportJson(m.report));
    EXPECT_EQ(json["schema"], 2);
    EXPECT_EQ(json["map"], m.report.name);
    EXPECT_EQ(json["size"], nlohmann::json({16, 16}));
    EXPECT_EQ(json["source"], m.mips.source);
    EXPECT_EQ(json["model"], "ashikhmin-shirley");
    EXPECT_EQ(json["seconds"], 1.5);
    EXPECT_GT(json["peak_mib"], 1.0);
    EXPECT_GT(json["threads"], 0);
    EXPECT_EQ(json["sampling"]["most_texels_a_level"], kReportTexels);
    EXPECT_GT(json["sampling"]["grid_points_a_side"], 90);
    EXPECT_GT(json["sampling"]["narrowest_deviation"], 0.0);
    ASSERT_EQ(json["levels"].size(), 4u);
    for (const auto& level : json["levels"]) {
        EXPECT_GT(level["measured_texels"], 0);
        ASSERT_EQ(level["methods"].size(), 7u);
        for (const auto& method : level["methods"]) {
            EXPECT_EQ(method["ks"], "best");
            for (const char* name : {"mean", "p95", "worst"}) {
                EXPECT_TRUE(method[name].is_number()) << name;
                EXPECT_TRUE(method["diffuse"][name].is_number()) << name;
                EXPECT_NEAR(method["measured"][name], method[name], 2e-3 * (1.0 + double(method[name])))
                    << method["method"] << " level " << level["level"];
            }
        }
    }
}

TEST(ReportMeasure, PageIsSelfContainedAndEscaped)
{
    const Measured m = measured(reportedMap());
    const std::string page = textOf(m.report);
    EXPECT_NE(page.find("&lt;rock&gt; &amp; &quot;roll&quot;.exr"), std::string::npos);
    EXPECT_EQ(page.find("<rock>"), std::string::npos);
    EXPECT_EQ(page.find("http"), std::string::npos) << "refers to an outside file";
    EXPECT_EQ(page.find("nan"), std::string::npos);
    // Levels of 64, 16, 4 and 1 texels: three rows each but one for the last, of seven discs and a map.
    EXPECT_EQ(count(page, "class='row'"), 10u);
    EXPECT_EQ(count(page, "data:image/png;base64,"), 10u * 9u + 1u);
    EXPECT_EQ(count(reportHtml(m.report), "base64,iVBORw0KGgo"), 10u * 9u + 1u) << "not PNG";
}

TEST(ReportMeasure, HandlesFlatBlackAndTinyMaps)
{
    Maps flat = normalMaps(constantImage(8, 8, {0.5f, 0.5f, 1.0f}), 500.0f);
    const Measured level = measured(flat);
    for (const MeasuredLevel& l : level.report.measured.levels)
        for (const ErrorFigures& e : l.figures)
            EXPECT_NEAR(e.worst, 0.0, 1e-6);
    EXPECT_EQ(textOf(level.report).find("nan"), std::string::npos);
    flat.specularConstant = glm::vec3(0.0f);
    const Measured black = measured(flat);
    EXPECT_EQ(black.report.measured.levels[0].figures[0].worst, 0.0);
    EXPECT_EQ(textOf(black.report).find("nan"), std::string::npos);
    const Measured one = measured(normalMaps(constantImage(1, 1, {0.5f, 0.5f, 1.0f}), 20.0f));
    EXPECT_TRUE(one.report.measured.levels.empty());
    EXPECT_FALSE(reportHtml(one.report).empty());
    EXPECT_THROW(writeReport("report.docx", one.report), Error);
}

TEST(ReportGrid, IntegratesTheDiscAndItsLobes)
{
    const DiscGrid grid(128);
    const std::vector<float> ones(grid.size(), 1.0f);
    EXPECT_NEAR(grid.integral(ones.data(), ones.data()), 3.14159265, 2e-3);
    for (const OracleLobe& lobe : {OracleLobe{0.2, -0.3, 0.01, 0.004, 0.02, 1.0, 1.0},
                                   OracleLobe{0.6, 0.5, 0.05, 0.0, 0.05, 1.0, 1.0}}) {
        std::vector<float> f(grid.size());
        grid.add({float(lobe.nx), float(lobe.ny), float(lobe.sxx), float(lobe.sxy), float(lobe.syy)}, 2.0f,
                 f.data());
        const OracleSums sums = oracleSums({lobe}, lobe, 600);
        EXPECT_NEAR(grid.integral(f.data(), f.data()), 4.0 * sums.ff, 4e-3 * sums.ff);
        EXPECT_NEAR(grid.integral(ones.data(), f.data()), 2.0 * sums.f, 4e-3 * sums.f);
    }
}

} // namespace lumel::baker
