// Two measurements side by side: how many times longer do the frames of the second take?
#pragma once
#include "core/statistics.h"
#include "runs.h"

namespace lumel::bench {

struct RunRatio {
    std::string name;
    Spread p50, p95; // of the second file's frame times to the first's
};

// Runs that both have: same scene, shading, size, lights and objects. Throws Error when there is none.
std::vector<RunRatio> compareRuns(const std::vector<Run>& a, const std::vector<Run>& b);
std::string tableOf(const std::vector<RunRatio>& ratios);
// The largest ratio of all.
double worstOf(const std::vector<RunRatio>& ratios);

} // namespace lumel::bench
