// What meshes feed to vertex shaders: fetched by the rasteriser, which on software Vulkan costs half of
// loading the same from storage buffers.
#pragma once
#include "gpu/pipeline.h"
#include "shared/structs.h"

namespace lumel {

// Bindings: the mesh's vertices, and the object table as instances (drawTriangles).
inline const std::vector<vk::VertexInputBindingDescription> kMeshBindings = {
    {0, sizeof(shared::Vertex), vk::VertexInputRate::eVertex},
    {1, sizeof(shared::Object), vk::VertexInputRate::eInstance}};

// Of these locations (kAttribute...): all that a shader reads, and nothing else.
std::vector<vk::VertexInputAttributeDescription> meshAttributes(std::initializer_list<uint32_t> locations);

} // namespace lumel
