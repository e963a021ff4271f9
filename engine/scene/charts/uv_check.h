// Are a mesh's UVs fit to be lit: does each point of [0, 1]^2 belong to at most one triangle?
#pragma once
#include "scene/scene.h"
#include <array>
#include <span>

namespace lumel::scene {

// Empty when they are, else the reason, as Mesh::uvProblem documents it.
std::string findUvProblem(const Mesh& mesh);

// UV areas, exact but for rounding; the whole texture is 1.
struct UvOverlap {
    double covered = 0.0;  // by one triangle or more
    double repeated = 0.0; // by two or more
    bool complete = true;  // false: too entangled to count to the end; repeated is then a lower bound
    double share() const { return covered > 0.0 ? repeated / covered : 0.0; }
};
UvOverlap findUvOverlap(const Mesh& mesh);

// Do the interiors of any two of these triangles meet, beyond what rounding does to touching ones?
// Coordinates about 1 in size; ends at the first such pair.
using FlatTriangle = std::array<glm::dvec2, 3>;
bool anyOverlap(std::span<const FlatTriangle> triangles);

} // namespace lumel::scene
