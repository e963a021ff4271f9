#include "floors.h"
#include "core/pass_names.h"
#include "core/statistics.h"
#include "runs.h"
#include <algorithm>
#include <fmt/format.h>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>

namespace lumel::bench {
namespace {

using nlohmann::json;

json medianOrNull(const std::vector<double>& values)
{
    return values.empty() ? json(nullptr) : json(percentile(values, 0.5));
}

// The median of what `of` says of the frames for which it says something.
template<class Of>
json medianOver(const std::vector<FloorFrame>& frames, const Of& of)
{
    std::vector<double> values;
    for (const FloorFrame& frame : frames)
        if (const std::optional<double> value = of(frame))
            values.push_back(*value);
    return medianOrNull(values);
}

std::optional<double> quotient(double a, double b)
{
    return b > 0.0 ? std::optional(a / b) : std::nullopt;
}

double passMs(const FloorFrame& frame, const std::string& pass)
{
    const auto found = frame.passMs.find(pass);
    return found == frame.passMs.end() ? 0.0 : found->second;
}

// What a pass works on: lumels lit, lumels derived or pixels.
struct Unit {
    const char* name;
    double FloorFrame::*count;
};
Unit unitOf(const std::string& pass)
{
    return pass == "light"   ? Unit{"lumel lit", &FloorFrame::lit}
           : pass == "lower" ? Unit{"lumel derived", &FloorFrame::derived}
                             : Unit{"pixel", &FloorFrame::pixels};
}

// Null: there is none.
json floorOf(const std::string& pass, const json& floors)
{
    const char* name = pass != "draw"               ? pass.c_str()
                       : floors.contains("forward") ? "forward"
                                                    : "bicubic_two_levels";
    return floors.value(name, json(nullptr));
}

// Over the frames in which it runs: the feedback pass does not in all.
json passOf(const std::string& pass, std::vector<FloorFrame> frames, const json& floors)
{
    const auto ran = [&](const FloorFrame& frame) { return passMs(frame, pass) > 0.0; };
    if (std::ranges::any_of(frames, ran))
        std::erase_if(frames, std::not_fn(ran));
    const Unit unit = unitOf(pass);
    const json ms = medianOver(frames, [&](const FloorFrame& f) { return std::optional(passMs(f, pass)); });
    const json ns = medianOver(
        frames, [&](const FloorFrame& f) { return quotient(1e6 * passMs(f, pass), f.*unit.count); });
    const json floor = floorOf(pass, floors);
    const bool both = !ns.is_null() && !floor.is_null() && floor > 0.0;
    return {{"ms", ms},
            {"unit", unit.name},
            {"ns", ns},
            {"floor_ns", floor},
            {"ratio", both ? json(ns.get<double>() / floor.get<double>()) : json(nullptr)}};
}

std::string text(const json& value, int digits)
{
    return value.is_null() ? "-" : fmt::format("{:.{}f}", value.get<double>(), digits);
}

std::string tableOfRun(const json& run, const std::string& name)
{
    const json& floors = run.at("floors");
    std::string table = fmt::format("\n{:<24} {:>8} {:>9} {:>9} {:>7} {:>9}  for each\n", name, "ms", "ns",
                                    "floor ns", "ratio", "above");
    for (const char* pass : kPassNames) {
        const json& of = floors.at("passes").at(pass);
        if (of.at("ms") == 0.0)
            continue;
        const json above = of.at("ratio").is_null()
                               ? json(nullptr)
                               : json(of.at("ns").get<double>() - of.at("floor_ns").get<double>());
        table += fmt::format("{:<24} {:>8} {:>9} {:>9} {:>7} {:>9}  {}\n", pass, text(of.at("ms"), 2),
                             text(of.at("ns"), 1), text(of.at("floor_ns"), 1), text(of.at("ratio"), 2),
                             text(above, 1), of.at("unit").get<std::string>());
    }
    table += fmt::format("frame {} ms, feedback + plan + lower {} %, lumels lit a pixel {}\n",
                         text(run.at("summary").at("p50_ms"), 2),
                         text(100.0 * floors.at("overhead_share").get<double>(), 1),
                         text(floors.at("lumels_per_pixel"), 3));
    table += "floors, ns:";
    for (const auto& [floor, ns] : floors.at("floor_ns").items())
        table += fmt::format(" {} {}", floor, text(ns, 2));
    return table + "\n";
}

} // namespace

json floorsOf(const std::vector<FloorFrame>& frames)
{
    std::map<std::string, std::vector<double>> measured;
    for (const FloorFrame& frame : frames)
        for (const auto& [name, ns] : frame.floorNs)
            measured[name].push_back(ns);
    json floors = json::object();
    for (const auto& [name, values] : measured)
        floors[name] = medianOrNull(values);
    json passes;
    for (const char* pass : kPassNames)
        passes[pass] = passOf(pass, frames, floors);
    double overhead = 0.0, whole = 0.0; // sums: frames with and without a feedback pass take turns
    for (const FloorFrame& f : frames) {
        overhead += passMs(f, "feedback") + passMs(f, "plan") + passMs(f, "lower");
        whole += f.ms;
    }
    const auto lumelsPerPixel = [](const FloorFrame& f) { return quotient(f.lit, f.pixels); };
    return {{"pixels", medianOver(frames, [](const FloorFrame& f) { return std::optional(f.pixels); })},
            {"overhead_share", whole > 0.0 ? json(overhead / whole) : json(nullptr)},
            {"lumels_per_pixel", medianOver(frames, lumelsPerPixel)},
            {"floor_ns", floors},
            {"passes", passes}};
}

std::string floorTables(const json& document)
{
    std::string tables;
    const std::vector<Run> runs = runsOf(document);
    for (size_t i = 0; i < runs.size(); ++i)
        if (const json& run = document.at("runs").at(i); run.contains("floors"))
            tables += tableOfRun(run, runs[i].name());
    return tables;
}

} // namespace lumel::bench
