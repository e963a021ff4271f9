// Are a mesh's UVs fit to be lit: does each point of [0, 1]^2 belong to at most one triangle?
#pragma once
#include "scene.h"

namespace lumel::scene {

// Empty when they are, else the reason, as Mesh::uvProblem documents it.
std::string findUvProblem(const Mesh& mesh);

// Share, in [0, 1], of the triangles' total UV area that lies on top of another triangle: 0 when none
// overlap, (k - 1) / k for k congruent layers. Exact but for rounding. `complete` is false when the
// triangles are so entangled that counting was given up; the share is then a lower bound.
struct UvOverlap {
    double share = 0.0;
    double area = 0.0; // UV area of that share
    bool complete = true;
};
UvOverlap findUvOverlap(const Mesh& mesh);

} // namespace lumel::scene
