#include "mesh_buffers.h"

namespace lumel {

// Shaders load what addresses name in units of 8 bytes.
static_assert(sizeof(shared::Vertex) % 8 == 0);
static constexpr size_t kIndexMultiple = 8 / sizeof(uint32_t);

gpu::SetLayout VertexTexels::makeLayout(const gpu::Device& device)
{
    return gpu::makeSetLayout(device, {vk::DescriptorType::eUniformTexelBuffer});
}

VertexTexels::VertexTexels(const gpu::Device& device, const gpu::SetLayout& layout,
                           const gpu::Buffer& vertices)
    : pool_(gpu::makePool(device, vk::DescriptorType::eUniformTexelBuffer, 1, 1)),
      view_(gpu::makeTexelView(device, vertices)), set_(gpu::makeSet(device, pool_, layout))
{
    gpu::writeTexels(device, *set_, 0, *view_);
}

MeshBuffers::MeshBuffers(const gpu::Device& device)
    : device_(device), texelLayout_(VertexTexels::makeLayout(device))
{
}

void MeshBuffers::upload(gpu::UploadBatch& batch, const std::vector<scene::Mesh>& meshes, size_t bytes)
{
    constexpr size_t kTexelBytes = 4 * sizeof(uint32_t);
    bytes = std::min(bytes, kTexelBytes * device_.limits().core.maxTexelBufferElements);
    const std::span all(meshes);
    for (size_t first = 0, end = 0; first < all.size(); first = end) {
        size_t sum = 0;
        do {
            sum += all[end++].vertices.size() * sizeof(shared::Vertex);
        } while (end < all.size() && sum + all[end].vertices.size() * sizeof(shared::Vertex) <= bytes);
        uploadSome(batch, all.subspan(first, end - first));
    }
}

void MeshBuffers::uploadSome(gpu::UploadBatch& batch, std::span<const scene::Mesh> meshes)
{
    const size_t firstPart = parts_.size();
    std::vector<shared::Vertex> vertices;
    std::vector<uint32_t> indices;
    for (const scene::Mesh& mesh : meshes) {
        MeshParts& parts = parts_.emplace_back();
        parts.vertices.first = uint32_t(vertices.size());
        parts.indices.first = uint32_t(indices.size());
        vertices.insert(vertices.end(), mesh.vertices.begin(), mesh.vertices.end());
        indices.insert(indices.end(), mesh.indices.begin(), mesh.indices.end());
        indices.resize((indices.size() + kIndexMultiple - 1) / kIndexMultiple * kIndexMultiple);
    }
    const gpu::Buffer& v =
        buffers_.emplace_back(batch.buffer(vertices, "vertices", gpu::MemoryKind::geometry));
    const auto place = [](BufferPart& part, const gpu::Buffer& buffer, size_t elementBytes) {
        part.buffer = buffer.handle();
        part.address = buffer.address() + part.first * elementBytes;
    };
    texels_.emplace_back(device_, texelLayout_, v);
    for (size_t i = firstPart; i < parts_.size(); ++i) {
        place(parts_[i].vertices, v, sizeof(shared::Vertex));
        parts_[i].texels = texels_.back().set();
    }
    const gpu::Buffer& n = buffers_.emplace_back(batch.buffer(indices, "indices", gpu::MemoryKind::geometry));
    for (size_t i = firstPart; i < parts_.size(); ++i)
        place(parts_[i].indices, n, sizeof(uint32_t));
}

} // namespace lumel
