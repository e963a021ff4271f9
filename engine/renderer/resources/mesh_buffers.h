// Vertices and indices of many meshes in few buffers: what shares them can be drawn by one indirect call.
#pragma once
#include "gpu/pipeline.h"
#include "gpu/upload.h"
#include "scene/scene.h"

namespace lumel {

// A buffer's vertices as texels: on software Vulkan these cost a compute shader a fifth of what loads by
// buffer references do.
class VertexTexels {
public:
    static gpu::SetLayout makeLayout(const gpu::Device& device); // all are alike
    // Throws Error when the buffer has more texels than the device takes.
    VertexTexels(const gpu::Device& device, const gpu::SetLayout& layout, const gpu::Buffer& vertices);
    vk::DescriptorSet set() const { return *set_; }

private:
    vk::raii::DescriptorPool pool_; // scenes are uploaded while others are rendered
    vk::raii::BufferView view_;
    vk::raii::DescriptorSet set_;
};

// Vertices or indices of a mesh.
struct BufferPart {
    vk::Buffer buffer;
    vk::DeviceAddress address = 0; // of the part
    uint32_t first = 0;            // element
};

struct MeshParts {
    BufferPart vertices, indices;
    vk::DescriptorSet texels; // of all vertices in the buffer
};

// Buffers of `bytes` of vertices; a larger mesh has one of its own.
class MeshBuffers {
public:
    static constexpr size_t kBytes = size_t(64) << 20;
    explicit MeshBuffers(const gpu::Device& device);
    // Both are to outlive the batch.
    void upload(gpu::UploadBatch& batch, const std::vector<scene::Mesh>& meshes, size_t bytes = kBytes);
    const std::vector<MeshParts>& parts() const { return parts_; } // by mesh
    const gpu::SetLayout& texelLayout() const { return texelLayout_; }

private:
    void uploadSome(gpu::UploadBatch& batch, std::span<const scene::Mesh> meshes);
    const gpu::Device& device_;
    gpu::SetLayout texelLayout_;
    std::vector<gpu::Buffer> buffers_;
    std::vector<VertexTexels> texels_;
    std::vector<MeshParts> parts_;
};

} // namespace lumel
