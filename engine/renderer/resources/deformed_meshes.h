// The deformed meshes of one renderer: the vertices of each, and the joints and weights that move them.
#pragma once
#include "geometry_resources.h"

namespace lumel {

class DeformedMeshes {
public:
    DeformedMeshes() = default;
    // meshes: the scene's, which outlive them.
    DeformedMeshes(const gpu::Device& device, const scene::Scene& scene, const std::vector<GpuMesh>& meshes);

    // By deformed mesh: have its vertices moved?
    std::vector<uint8_t> set(const scene::Shapes& shapes);

    struct Item {
        gpu::Buffer vertices;
        shared::DeformPush push{};
        scene::Extents extents;
        int skin = -1;
        Bounds bounds;              // object space
        bool mirrored = false;      // the joints flip triangle winding
        bool stale = true;          // the vertices are not where they should be
        std::vector<float> weights; // as last set
    };
    const std::vector<Item>& items() const { return items_; }
    void markFresh(size_t item) { items_[item].stale = false; }

private:
    Item makeItem(const gpu::Device& device, const scene::Scene& scene, const std::vector<GpuMesh>& meshes,
                  size_t index) const;

    gpu::Buffer matrices_, weights_; // of all skins, of all items
    std::vector<size_t> firstMatrix_, firstWeight_;
    std::vector<scene::Matrices> joints_; // by skin, as last set
    std::vector<Item> items_;
};

} // namespace lumel
