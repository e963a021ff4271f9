#include "report.h"
#include "core/error.h"
#include "core/file.h"
#include "lookup.h"
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sys/resource.h>

namespace lumel::baker {
namespace {

MethodErrors errorsOf(const std::string& method, const Level& level)
{
    std::vector<float> errors;
    for (size_t i = kError; i < level.texels.size(); i += kChannels)
        errors.push_back(level.texels[i]);
    std::sort(errors.begin(), errors.end());
    double sum = 0.0;
    for (const float e : errors)
        sum += e;
    const size_t p95 = std::min(errors.size() - 1, size_t(double(errors.size()) * 0.95));
    return {method, sum / double(errors.size()), errors[p95], errors.back()};
}

double peakMiB()
{
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return double(usage.ru_maxrss) / 1024.0;
}

// Bakes for the other reconstruction too and looks both up between texels.
void compareLookups(const Maps& maps, const Options& options, const ReflectanceMips& mips, Report& report)
{
    constexpr int kLastLevel = 4, kSamples = 200;
    Options other = options;
    const bool isBox = options.reconstruction == Reconstruction::box;
    other.reconstruction = isBox ? Reconstruction::bilinear : Reconstruction::box;
    const ReflectanceMips second = bake(maps, other);
    for (LevelReport& level : report.levels) {
        if (level.level > kLastLevel)
            break;
        const size_t l = size_t(level.level - options.reduce);
        level.boxLookup = lookupError(maps, isBox ? mips : second, l, kSamples);
        level.bilinearLookup = lookupError(maps, isBox ? second : mips, l, kSamples);
    }
}

nlohmann::ordered_json figuresJson(const ErrorFigures& figures)
{
    return {{"mean", figures.mean}, {"p95", figures.p95}, {"worst", figures.worst}};
}

} // namespace

Report makeReport(const Maps& maps, const Options& options, const ReflectanceMips& mips, double seconds,
                  Progress* progress)
{
    Report report{mips.model, mips.source, seconds, peakMiB(), {}, {}, {}};
    const int first = options.reduce;
    for (size_t l = first > 0 ? 0 : 1; l < mips.levels.size(); ++l)
        report.levels.push_back({int(l) + first,
                                 mips.levels[l].width,
                                 mips.levels[l].height,
                                 {errorsOf(mips.method, mips.levels[l])}});
    const auto addClosedForm = [&](const ReflectanceMips& other) {
        for (LevelReport& level : report.levels)
            level.methods.push_back(errorsOf(other.method, other.levels[size_t(level.level - first)]));
    };
    report.measured = measure(maps, options, mips, addClosedForm, progress);
    compareLookups(maps, options, mips, report);
    return report;
}

std::string reportJson(const Report& report)
{
    using json = nlohmann::ordered_json;
    const Measurement& measured = report.measured;
    json document;
    document["schema"] = 2;
    document["map"] = report.name;
    document["size"] = {measured.width, measured.height};
    document["model"] = report.model;
    document["source"] = report.source;
    document["seconds"] = report.seconds;
    document["threads"] = measured.threads;
    document["peak_mib"] = report.peakMiB;
    document["sampling"] = {{"most_texels_a_level", kReportTexels},
                            {"grid_points_a_side", measured.gridSide},
                            {"narrowest_deviation", measured.narrowestDeviation}};
    document["levels"] = json::array();
    for (size_t l = 0; l < report.levels.size(); ++l) {
        const LevelReport& level = report.levels[l];
        const MeasuredLevel& brute = measured.levels[l];
        json methods = json::array();
        for (size_t m = 0; m < level.methods.size(); ++m) {
            const MethodErrors& e = level.methods[m];
            methods.push_back({{"method", e.method},
                               {"ks", m == 0 && measured.meanKs ? "mean" : "best"},
                               {"mean", e.mean},
                               {"p95", e.p95},
                               {"worst", e.worst},
                               {"measured", figuresJson(brute.figures[m])},
                               {"diffuse", figuresJson(brute.diffuse[m])}});
        }
        json entry = {{"level", level.level},
                      {"width", level.width},
                      {"height", level.height},
                      {"measured_texels", brute.sample.size()},
                      {"methods", std::move(methods)}};
        if (level.boxLookup >= 0.0)
            entry["lookup"] = {{"box", level.boxLookup}, {"bilinear", level.bilinearLookup}};
        document["levels"].push_back(std::move(entry));
    }
    return document.dump(1, ' ', false, json::error_handler_t::replace) + "\n";
}

void writeReport(const std::filesystem::path& file, const Report& report)
{
    const std::string extension = file.extension().string();
    if (extension != ".json" && extension != ".html")
        throw Error(
            fmt::format("{}: a report is .json or .html; give it one of these extensions", file.string()));
    writeFileAtomically(file, extension == ".json" ? reportJson(report) : reportHtml(report));
}

} // namespace lumel::baker
