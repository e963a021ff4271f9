// The deformed meshes of one renderer: the vertices of each, and the joints and weights that move them.
#pragma once
#include "geometry_resources.h"
#include "gpu/frame_ring.h"
#include <array>
#include <optional>

namespace lumel {

class DeformedMeshes {
public:
    DeformedMeshes() = default;
    // geometry: the scene's, which outlives them.
    DeformedMeshes(const gpu::Device& device, const scene::Scene& scene, const GeometryResources& geometry);

    // By deformed mesh: have its vertices moved?
    std::vector<uint8_t> set(const scene::Shapes& shapes);

    struct Item {
        gpu::Buffer vertices;
        std::optional<VertexTexels> texels; // of the vertices
        shared::DeformPush push{};          // but for what lies in the ring
        scene::Extents extents;
        int skin = -1;
        Bounds bounds;              // object space
        bool mirrored = false;      // the joints flip triangle winding
        bool stale = true;          // the vertices are not where they should be
        std::vector<float> weights; // as last set
    };
    const std::vector<Item>& items() const { return items_; }
    // The place of the next frame in the ring of joints and weights.
    void begin(uint32_t place);
    // Writes what moves the item for that frame, which brings its vertices up to date.
    shared::DeformPush write(size_t item);

private:
    Item makeItem(const gpu::Device& device, const scene::Scene& scene, const GeometryResources& geometry,
                  size_t index) const;

    struct Place {                     // made when first needed
        gpu::Buffer matrices, weights; // of all skins, of all items
    };
    const gpu::Device* device_ = nullptr;
    std::array<Place, gpu::FrameRing::kMostFrames> places_;
    uint32_t place_ = 0;
    size_t matrixCount_ = 0, weightCount_ = 0;
    std::vector<size_t> firstMatrix_, firstWeight_;
    std::vector<scene::Matrices> joints_; // by skin, as last set
    std::vector<Item> items_;
};

} // namespace lumel
