// Cuts a mesh into charts: connected pieces that lie flat on a plane, without folds, at a bounded stretch.
#pragma once
#include "uv_check.h"

namespace lumel::scene {

struct Chart {
    std::vector<uint32_t> triangles;
    glm::dvec3 axis{0.0}; // unit: normal of the plane that the chart is projected on
};

// No triangle of a chart is tilted against the chart's plane by more than this. Projected on the plane, it is
// then compressed to no less than cos 45 degrees, so that lengths of one lumel in one direction are at most
// kMostStretch in the other.
inline constexpr double kLeastCosine = 0.70710678118654752;
inline constexpr double kMostStretch = 1.0 / kLeastCosine;

// All triangles that have an area in space, each in one chart. The same mesh always gives the same charts.
std::vector<Chart> cutCharts(const Mesh& mesh);

// The chart on its plane, in metres, counter-clockwise seen against the axis; turned so that its upright box
// around it is small.
std::vector<FlatTriangle> flatten(const Mesh& mesh, const Chart& chart);

} // namespace lumel::scene
