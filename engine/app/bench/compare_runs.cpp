#include "compare_runs.h"
#include "core/error.h"
#include <fmt/format.h>

namespace lumel::bench {
namespace {

std::vector<double> times(const Run& run)
{
    std::vector<double> ms;
    for (const FrameRecord& frame : run.frames)
        ms.push_back(frame.ms);
    return ms;
}

} // namespace

std::vector<RunRatio> compareRuns(const std::vector<Run>& a, const std::vector<Run>& b)
{
    std::vector<RunRatio> ratios;
    std::vector<bool> taken(b.size(), false);
    for (const Run& before : a)
        for (size_t i = 0; i < b.size(); ++i) {
            if (taken[i] || b[i].name() != before.name())
                continue;
            taken[i] = true; // runs of one name pair up in order
            const auto from = times(before), to = times(b[i]);
            ratios.push_back(
                {before.name(), percentileRatio(from, to, 0.5), percentileRatio(from, to, 0.95)});
            break;
        }
    if (ratios.empty())
        throw Error(fmt::format("the measurements have no run in common (first: '{}' and '{}'); measure the "
                                "same scenes, shadings and sizes",
                                a.front().name(), b.front().name()));
    return ratios;
}

std::string tableOf(const std::vector<RunRatio>& ratios)
{
    size_t width = 3;
    for (const RunRatio& ratio : ratios)
        width = std::max(width, ratio.name.size());
    const auto text = [](const Spread& s) {
        return fmt::format("{:.3f} ({:.3f} to {:.3f})", s.value, s.low, s.high);
    };
    std::string table = fmt::format("{:<{}}  {:<24}  {:<24}\n", "run", width, "p50 ratio (95 % range)",
                                    "p95 ratio (95 % range)");
    for (const RunRatio& ratio : ratios)
        table += fmt::format("{:<{}}  {:<24}  {:<24}\n", ratio.name, width, text(ratio.p50), text(ratio.p95));
    return table;
}

double worstOf(const std::vector<RunRatio>& ratios)
{
    double worst = 0.0;
    for (const RunRatio& ratio : ratios)
        worst = std::max({worst, ratio.p50.value, ratio.p95.value});
    return worst;
}

} // namespace lumel::bench
