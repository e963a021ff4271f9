// Lit UVs: which coordinates a mesh's lumels lie at.
#pragma once
#include "scene/scene.h"
#include <span>

namespace lumel::scene {

// Sets Vertex::uv of all vertices from the first of `sets` whose coordinates are unique, else from the first;
// and Mesh::uvProblem. The sets have one coordinate per vertex, or none at all.
void chooseLitUvs(std::span<const std::vector<glm::vec2>> sets, Mesh& mesh);

// Unwraps every mesh with a uvProblem that an opaque object uses, all at once, and logs how well that went.
// Meshes that took a while are kept in the cache folder. A mesh that cannot be unwrapped keeps its problem,
// with the reason added.
void unwrapMeshes(Scene& scene);

} // namespace lumel::scene
