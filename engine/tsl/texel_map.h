// Which triangle each lumel lies on, for every level: made once per mesh and lumel grid.
#pragma once
#include "core/uninitialised.h"
#include "scene/scene.h"
#include <array>
#include <cstdint>

namespace lumel::tsl {

// Lumels around charts that extend the nearest triangle: the reach of a cubic filter's taps.
inline constexpr int kGutter = 3;

struct TexelMap {
    glm::uvec2 size{0};                                 // lumels of level 0, powers of two
    uint32_t levels = 0;                                // down to 1 x 1
    std::array<uint32_t, shared::kMaxLevels> offsets{}; // first entry of each level
    // Triangle + 1 in the low 24 bits (0: no surface near), coverage 0..255 in the high 8 (0: gutter).
    // Coverage is the share of the lumel that charts cover, at the resolution of level-0 lumel centres.
    UninitialisedArray<uint32_t> texels;

    glm::uvec2 levelSize(uint32_t level) const { return glm::max(size >> level, glm::uvec2(1)); }
    uint32_t at(uint32_t level, uint32_t x, uint32_t y) const
    {
        return texels[offsets[level] + size_t(y) * levelSize(level).x + x];
    }
};

// Rasterises the mesh's texture coordinates, which must be unique in [0, 1]. `size`: powers of two, at most
// 8192. A mesh of more than 2^24 - 1 triangles cannot be indexed: throws Error naming it.
TexelMap makeTexelMap(const scene::Mesh& mesh, glm::uvec2 size);

// Level-0 lumel grid of an object by the sizes of its material's maps in texels: twice the next power of two,
// because light reflected by interpolated normals varies faster than the normals do (measured on the record's
// grooves, near: 34.5 dB against the reference, 24.5 dB with lumels as large as texels). Only views that need
// that level light it. Emission and occlusion do not vary faster than their texels: the next power of two
// is enough for them. At least kMinGrid, so that light still varies over a plain colour; at most kMaxGrid.
inline constexpr uint32_t kMinGrid = 1024, kMaxGrid = 8192;
glm::uvec2 lumelGrid(glm::ivec2 material, glm::ivec2 emissive);

// The same for a mesh whose lit UVs are not its material UVs: square, and as many lumels on a surface as
// there would be if they were the same, to the nearest power of two, at most kMaxOwnGrid. At least so fine
// that unwrapped charts stay clear of each other's filter taps.
inline constexpr uint32_t kMaxOwnGrid = 4096;
glm::uvec2 lumelGrid(const scene::Mesh& mesh, glm::ivec2 material, glm::ivec2 emissive);

} // namespace lumel::tsl
