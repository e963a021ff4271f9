// What device memory is used for. Knows no Vulkan.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>

namespace lumel::gpu {

// targets: pictures, shadow maps and what else is rendered to. materials: the environment, too.
enum class MemoryKind {
    litTextures,
    surfaceCache,
    materials,
    geometry,
    texelMaps,
    targets,
    buffers,
    staging
};
constexpr std::array kMemoryKindNames = {"lit_textures", "surface_cache", "materials", "geometry",
                                         "texel_maps",   "targets",       "buffers",   "staging"};

struct MemoryReport {
    std::array<uint64_t, kMemoryKindNames.size()> bytes{}; // in use, by MemoryKind
    uint64_t allocatedBytes = 0;                           // from the driver
    uint32_t allocations = 0;                              // likewise

    uint64_t usedBytes() const { return std::accumulate(bytes.begin(), bytes.end(), uint64_t(0)); }
    uint64_t of(MemoryKind kind) const { return bytes[size_t(kind)]; }
};

} // namespace lumel::gpu
