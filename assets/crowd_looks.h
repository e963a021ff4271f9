// What the crowd and the stress scene are made of: ten turned shapes, eight materials, wet slabs.
#pragma once
#include "gltf_writer.h"
#include "pieces.h"
#include <array>

namespace lumel::assets {

inline constexpr size_t kCrowdLooks = 8;

// Indices of the writer.
struct CrowdLooks {
    std::array<int, kCrowdLooks> materials;
    std::array<int, kPieceCount> shapes;
    int ground; // material of a square tile of 16 x 16 slabs; tiles meet at joints
};
CrowdLooks addCrowdLooks(GltfWriter& gltf);

} // namespace lumel::assets
