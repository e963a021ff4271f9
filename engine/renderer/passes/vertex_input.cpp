#include "vertex_input.h"

namespace lumel {
namespace {

struct Source {
    uint32_t binding;
    vk::Format format;
    size_t offset;
    uint32_t columns = 1; // locations that follow each other
    size_t columnBytes = 0;
};

Source sourceOf(uint32_t location)
{
    using shared::Object, shared::Vertex;
    switch (location) {
    case shared::kAttributePosition:
        return {0, vk::Format::eR32G32B32Sfloat, offsetof(Vertex, position)};
    case shared::kAttributeNormal:
        return {0, vk::Format::eR32G32B32Sfloat, offsetof(Vertex, normal)};
    case shared::kAttributeTangent:
        return {0, vk::Format::eR32G32B32A32Sfloat, offsetof(Vertex, tangent)};
    case shared::kAttributeUv:
        return {0, vk::Format::eR32G32Sfloat, offsetof(Vertex, uv)};
    case shared::kAttributeMaterialUv:
        static_assert(offsetof(Vertex, emissionUv) == offsetof(Vertex, materialUv) + sizeof(glm::vec2));
        return {0, vk::Format::eR32G32B32A32Sfloat, offsetof(Vertex, materialUv)};
    case shared::kAttributeWorld:
        return {1, vk::Format::eR32G32B32A32Sfloat, offsetof(Object, worldFromObject), 4, sizeof(glm::vec4)};
    default: // kAttributeWorldNormal
        return {1, vk::Format::eR32G32B32Sfloat, offsetof(Object, worldFromObjectNormal), 3,
                sizeof(glm::vec3)};
    }
}

} // namespace

std::vector<vk::VertexInputAttributeDescription> meshAttributes(std::initializer_list<uint32_t> locations)
{
    std::vector<vk::VertexInputAttributeDescription> attributes;
    for (const uint32_t location : locations) {
        const Source source = sourceOf(location);
        for (uint32_t i = 0; i < source.columns; ++i)
            attributes.push_back({location + i, source.binding, source.format,
                                  uint32_t(source.offset + i * source.columnBytes)});
    }
    return attributes;
}

} // namespace lumel
