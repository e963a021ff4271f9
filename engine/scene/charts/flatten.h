// Charts on their planes.
#pragma once
#include "charts.h"
#include "uv_check.h"

namespace lumel::scene {

// The chart projected along its axis, in metres, counter-clockwise; turned so that its upright box is small.
std::vector<FlatTriangle> flatten(const Mesh& mesh, const Chart& chart);

// Does the chart, projected, lie on itself anywhere?
bool folds(const Mesh& mesh, const Chart& chart);

} // namespace lumel::scene
