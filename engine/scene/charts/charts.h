// Cuts a mesh into charts: connected pieces that lie flat on a plane, without folds, at a bounded stretch.
#pragma once
#include "scene/scene.h"

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

// One number for each distinct position: charts grow across vertices that were split for other attributes.
std::vector<uint32_t> weldPositions(const Mesh& mesh);

// Triangles thinner than this (height by longest edge) count as without area: across the whole texture they
// are a twentieth of a lumel, and their normals are rounding.
inline constexpr double kThinnest = 1e-5;

// All triangles that have an area in space, each in one chart. The same mesh always gives the same charts.
std::vector<Chart> cutCharts(const Mesh& mesh);

} // namespace lumel::scene
