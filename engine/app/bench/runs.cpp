#include "runs.h"
#include "core/error.h"
#include "core/file.h"
#include "core/pass_names.h"
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace lumel::bench {
namespace {

using nlohmann::json;

std::optional<double> orNone(const json& value)
{
    return value.is_null() ? std::nullopt : std::optional(value.get<double>());
}

FrameRecord frameOf(const json& in)
{
    FrameRecord frame;
    frame.ms = in.at("ms").get<double>();
    frame.passMs = in.at("passes").get<std::map<std::string, double>>();
    const json& lumels = in.at("lumels");
    frame.marked = lumels.at("marked").get<double>();
    frame.lit = lumels.at("lit").get<double>();
    frame.derived = lumels.at("derived").get<double>();
    frame.kept = lumels.at("kept").get<double>();
    frame.pending = lumels.at("pending").get<double>();
    frame.poolBytes = in.at("pool").at("used_bytes").get<double>();
    frame.renderScale = in.at("render_scale").get<double>();
    frame.errorRmse = orNone(in.at("error_rmse"));
    frame.flickerRmse = orNone(in.at("flicker_rmse"));
    return frame;
}

Run runOf(const json& in)
{
    Run run;
    run.scene = in.at("scene").get<std::string>();
    run.shading = in.at("shading").get<std::string>();
    run.filter = in.at("filter").get<std::string>();
    run.width = in.at("size").at(0).get<int>();
    run.height = in.at("size").at(1).get<int>();
    run.options = in.at("options").get<std::map<std::string, std::string>>();
    for (const json& frame : in.at("frames"))
        run.frames.push_back(frameOf(frame));
    const json& summary = in.at("summary");
    run.meanMs = summary.at("mean_ms").get<double>();
    run.p50Ms = summary.at("p50_ms").get<double>();
    run.p95Ms = summary.at("p95_ms").get<double>();
    run.p99Ms = summary.at("p99_ms").get<double>();
    run.maxMs = summary.at("max_ms").get<double>();
    run.missed = summary.at("missed").get<size_t>();
    run.errorRmse = orNone(summary.at("error_rmse"));
    run.flickerRmse = orNone(summary.at("flicker_rmse"));
    run.changeRmse = orNone(summary.at("change_rmse"));
    return run;
}

std::string option(const Run& run, const char* name)
{
    const auto found = run.options.find(name);
    return found == run.options.end() ? "" : found->second;
}

std::string quoted(const std::string& text)
{
    if (text.find_first_of(",\"\n") == std::string::npos)
        return text;
    std::string result = "\"";
    for (char c : text)
        result += c == '"' ? "\"\"" : std::string(1, c);
    return result + "\"";
}

std::string numberOr(std::optional<double> value, const char* format, const char* none)
{
    return value ? fmt::format(fmt::runtime(format), *value) : none;
}

} // namespace

std::string Run::name() const
{
    std::string text =
        fmt::format("{} {} {}x{}", std::filesystem::path(scene).stem().string(), shading, width, height);
    for (const char* what : {"lights", "objects"})
        if (const std::string count = option(*this, what); !count.empty())
            text += fmt::format(" {} {}", count, what);
    return text;
}

double Run::budgetMs() const
{
    const std::string text = option(*this, "budget-ms");
    return text.empty() ? 0.0 : std::strtod(text.c_str(), nullptr);
}

double Run::mean(double FrameRecord::*value) const
{
    double sum = 0.0;
    for (const FrameRecord& frame : frames)
        sum += frame.*value;
    return sum / double(frames.size());
}

double Run::meanPass(const std::string& pass) const
{
    double sum = 0.0;
    for (const FrameRecord& frame : frames)
        if (const auto ms = frame.passMs.find(pass); ms != frame.passMs.end())
            sum += ms->second;
    return sum / double(frames.size());
}

std::vector<Run> runsOf(const json& document)
{
    std::vector<Run> runs;
    if (document.contains("runs"))
        for (const json& run : document.at("runs"))
            runs.push_back(runOf(run));
    else
        runs.push_back(runOf(document)); // of `shot --stats`
    return runs;
}

std::vector<Run> readRuns(const std::filesystem::path& file)
{
    constexpr size_t kMaxBytes = size_t(1) << 30;
    const std::vector<std::byte> bytes = readFile(file, kMaxBytes);
    const char* text = reinterpret_cast<const char*>(bytes.data());
    const auto fail = [&](const std::string& why) {
        throw Error(fmt::format("{}: {}; name a file that lumel bench --json wrote", file.string(), why));
    };
    std::vector<Run> runs;
    try {
        const json document = json::parse(text, text + bytes.size());
        if (!document.is_object() || document.value("schema", json()) != 1)
            fail("not a measurement of schema 1");
        runs = runsOf(document);
    } catch (const json::parse_error& e) {
        const size_t at = std::min(e.byte, bytes.size());
        fail(fmt::format("not JSON (line {})", 1 + std::count(text, text + at, '\n')));
    } catch (const json::exception& e) {
        fail(fmt::format("not a measurement ({})", e.what()));
    }
    if (runs.empty())
        fail("it holds no run");
    for (const Run& run : runs) {
        if (run.frames.empty())
            fail("a run without frames");
        for (const FrameRecord& frame : run.frames)
            if (!(frame.ms > 0.0))
                fail("a frame that took no time");
    }
    return runs;
}

std::string tableOf(const std::vector<Run>& runs)
{
    size_t width = 3;
    bool quality = false;
    for (const Run& run : runs) {
        width = std::max(width, run.name().size());
        quality = quality || run.errorRmse || run.flickerRmse;
    }
    std::string table = fmt::format(
        "{:<{}} {:>6} {:>8} {:>8} {:>8} {:>8} {:>8} {:>6} {:>7} {:>7} {:>6} {:>7}", "run", width, "frames",
        "mean ms", "p50", "p95", "p99", "max", "missed", "light", "draw", "lumels", "kept %");
    if (quality)
        table += fmt::format(" {:>9} {:>7} {:>9}", "error", "dB", "flicker");
    table += '\n';
    for (const Run& run : runs) {
        const double marked = run.mean(&FrameRecord::marked);
        table += fmt::format(
            "{:<{}} {:>6} {:>8.1f} {:>8.1f} {:>8.1f} {:>8.1f} {:>8.1f} {:>6} {:>7.1f} {:>7.1f} {:>5.0f}k "
            "{:>7}",
            run.name(), width, run.frames.size(), run.meanMs, run.p50Ms, run.p95Ms, run.p99Ms, run.maxMs,
            run.missed, run.meanPass("light"), run.meanPass("draw"), run.mean(&FrameRecord::lit) / 1000.0,
            marked > 0.0 ? fmt::format("{:.1f}", 100.0 * run.mean(&FrameRecord::kept) / marked) : "-");
        if (quality) {
            const auto decibels = run.errorRmse && *run.errorRmse > 0.0
                                      ? std::optional(-20.0 * std::log10(*run.errorRmse))
                                      : std::nullopt;
            table += fmt::format(" {:>9} {:>7} {:>9}", numberOr(run.errorRmse, "{:.5f}", "-"),
                                 numberOr(decibels, "{:.2f}", "-"), numberOr(run.flickerRmse, "{:.5f}", "-"));
        }
        table += '\n';
    }
    return table;
}

std::string csvOf(const std::vector<Run>& runs)
{
    std::string csv = "scene,shading,filter,width,height,lights,objects,frame,ms";
    for (const char* pass : kPassNames)
        csv += fmt::format(",{}_ms", pass);
    csv += ",lumels_marked,lumels_lit,lumels_derived,lumels_kept,lumels_pending,pool_bytes,render_scale,"
           "error_rmse,flicker_rmse\r\n";
    for (const Run& run : runs) {
        const std::string head =
            fmt::format("{},{},{},{},{},{},{}", quoted(run.scene), run.shading, run.filter, run.width,
                        run.height, option(run, "lights"), option(run, "objects"));
        for (size_t i = 0; i < run.frames.size(); ++i) {
            const FrameRecord& f = run.frames[i];
            csv += fmt::format("{},{},{}", head, i, f.ms);
            for (const char* pass : kPassNames) {
                const auto ms = f.passMs.find(pass);
                csv += fmt::format(",{}", ms == f.passMs.end() ? 0.0 : ms->second);
            }
            csv += fmt::format(",{},{},{},{},{},{},{},{},{}\r\n", f.marked, f.lit, f.derived, f.kept,
                               f.pending, f.poolBytes, f.renderScale, numberOr(f.errorRmse, "{}", ""),
                               numberOr(f.flickerRmse, "{}", ""));
        }
    }
    return csv;
}

} // namespace lumel::bench
