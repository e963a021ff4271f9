// Meshes that deform: skins and morph targets as data, and where they take vertices and boxes.
#pragma once
#include "core/math.h"
#include "shared/structs.h"
#include <span>
#include <utility>
#include <vector>

namespace lumel::scene {

struct Animation;
struct Mesh;
struct Scene;

// What bounds a mesh in any pose, without its vertices.
struct Extents {
    Bounds mesh;                 // at rest
    std::vector<Bounds> targets; // around what each morph target adds to positions at weight 1
    std::vector<std::pair<uint32_t, Bounds>> joints; // around the vertices that each joint influences
};

// How a mesh's vertices follow joints and morph targets. Empty for meshes that do not.
struct Deformation {
    uint32_t jointsPerVertex = 0;
    std::vector<shared::Influence> influences; // jointsPerVertex of each vertex, the last ones may weigh 0
    // Deltas by vertex, in the order of the targets: those of vertex i are firstDeltas[i] up to
    // firstDeltas[i + 1]. Most targets move a part of the mesh.
    std::vector<uint32_t> firstDeltas;
    std::vector<shared::MorphDelta> deltas;
    Extents extents;
};

// Vertex i of the result is vertex sources[i] of `deformation`.
Deformation gathered(const Deformation& deformation, std::span<const uint32_t> sources);

struct Joint {
    int node = -1;                  // in Animation::nodes, -1: stands still
    glm::mat4 worldFromJoint{1.0f}; // as the nodes say
    glm::mat4 jointFromMesh{1.0f};  // its inverse bind matrix
};
struct Skin {
    std::vector<Joint> joints;
};

// A mesh deformed by a skin, by weights of morph targets, or both. Objects that deform alike share one.
struct DeformedMesh {
    int mesh = 0;
    int skin = -1;              // in Scene::skins; then vertices end up in world space
    int weightTrack = -1;       // in Animation::weights, -1: the weights stay
    std::vector<float> weights; // of the morph targets, as the node or the mesh says
    Bounds bounds;              // as the nodes say, in object space
};

using Matrices = std::vector<glm::mat4>;
// Of the skin's joints, from the mesh to world space. An empty pose: as the nodes say.
Matrices jointMatrices(const Skin& skin, const Matrices& pose = {});

// What deforms all meshes at one time.
struct Shapes {
    std::vector<Matrices> joints;            // by skin
    std::vector<std::vector<float>> weights; // by deformed mesh
};
Shapes shapesAtRest(const Scene& scene); // as the nodes say
Shapes shapesAt(const std::vector<Skin>& skins, const std::vector<DeformedMesh>& deformed,
                const Animation& animation, double seconds);

// A box around the deformed mesh: around its joints' boxes wherever they are, since each vertex lies between
// the places where its joints would take it. No matrices: no skin.
Bounds deformedBounds(const Extents& extents, std::span<const glm::mat4> matrices,
                      std::span<const float> weights);
std::vector<shared::Vertex> deformedVertices(const Mesh& mesh, std::span<const glm::mat4> matrices,
                                             std::span<const float> weights);

// As the nodes say, in object space.
// As the nodes say; nothing where the mesh does not deform. `deformed`: in Scene::deformed, -1 none.
std::vector<shared::Vertex> deformedVertices(const Scene& scene, int deformed);

Bounds objectBounds(const Scene& scene, size_t object);

} // namespace lumel::scene
