// Nodes of a glTF file at a moment of its animations.
#pragma once
#include "gltf_values.h"

namespace lumel::judge {

struct Pose {
    std::vector<glm::dmat4> worldFromNode;
    std::vector<std::vector<double>> weights; // of the morph targets of each node's mesh
    std::vector<bool> inScene;
};

Pose poseAt(const tinygltf::Model& model, double seconds);

} // namespace lumel::judge
