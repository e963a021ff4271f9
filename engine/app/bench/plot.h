// Frame time, render scale and lumels over the frames, a line a run.
#pragma once
#include "core/image.h"
#include "runs.h"

namespace lumel::bench {

// 1280 x 800, display values. Throws Error when no font is installed.
Image plotRuns(const std::vector<Run>& runs);

} // namespace lumel::bench
