// Vertices and indices of many meshes in few buffers: what shares them can be drawn by one indirect call.
#pragma once
#include "gpu/upload.h"
#include "scene/scene.h"

namespace lumel {

// Vertices or indices of a mesh.
struct BufferPart {
    vk::Buffer buffer;
    vk::DeviceAddress address = 0; // of the part
    uint32_t first = 0;            // element
};

struct MeshParts {
    BufferPart vertices, indices;
};

// Buffers of `bytes` of vertices; a larger mesh has one of its own.
class MeshBuffers {
public:
    static constexpr size_t kBytes = size_t(64) << 20;
    // Both are to outlive the batch.
    void upload(gpu::UploadBatch& batch, const std::vector<scene::Mesh>& meshes, size_t bytes = kBytes);
    const std::vector<MeshParts>& parts() const { return parts_; } // by mesh

private:
    void uploadSome(gpu::UploadBatch& batch, std::span<const scene::Mesh> meshes);
    std::vector<gpu::Buffer> buffers_;
    std::vector<MeshParts> parts_;
};

} // namespace lumel
