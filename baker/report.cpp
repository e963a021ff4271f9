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

} // namespace

Report makeReport(const Maps& maps, const Options& options, const ReflectanceMips& mips, double seconds)
{
    Report report{mips.model, mips.source, seconds, peakMiB(), {}};
    const int first = options.reduce;
    for (size_t l = first > 0 ? 0 : 1; l < mips.levels.size(); ++l)
        report.levels.push_back({int(l) + first,
                                 mips.levels[l].width,
                                 mips.levels[l].height,
                                 {errorsOf(mips.method, mips.levels[l])}});
    for (const Method method :
         {Method::flat, Method::height, Method::average, Method::toksvig, Method::lean}) {
        if (method == options.method || (method == Method::height && maps.height.empty()))
            continue;
        Options closed = options;
        closed.method = method;
        const ReflectanceMips other = bake(maps, closed);
        for (LevelReport& level : report.levels)
            level.methods.push_back(errorsOf(other.method, other.levels[size_t(level.level - first)]));
    }
    compareLookups(maps, options, mips, report);
    return report;
}

std::string reportJson(const Report& report)
{
    nlohmann::ordered_json json;
    json["schema"] = 1;
    json["model"] = report.model;
    json["source"] = report.source;
    json["seconds"] = report.seconds;
    json["peak_mib"] = report.peakMiB;
    json["levels"] = nlohmann::ordered_json::array();
    for (const LevelReport& level : report.levels) {
        nlohmann::ordered_json l{{"level", level.level}, {"width", level.width}, {"height", level.height}};
        l["methods"] = nlohmann::ordered_json::array();
        for (const MethodErrors& m : level.methods)
            l["methods"].push_back(
                {{"method", m.method}, {"mean", m.mean}, {"p95", m.p95}, {"worst", m.worst}});
        if (level.boxLookup >= 0.0)
            l["lookup"] = {{"box", level.boxLookup}, {"bilinear", level.bilinearLookup}};
        json["levels"].push_back(std::move(l));
    }
    return json.dump(1) + "\n";
}

void writeReport(const std::filesystem::path& file, const Maps& maps, const Options& options,
                 const ReflectanceMips& mips, double seconds)
{
    const std::string extension = file.extension().string();
    if (extension != ".json" && extension != ".html")
        throw Error(fmt::format("{}: a report is .json or .html; end its name so", file.string()));
    const Report report = makeReport(maps, options, mips, seconds);
    writeFileAtomically(file,
                        extension == ".json" ? reportJson(report) : reportHtml(maps, options, mips, report));
}

} // namespace lumel::baker
