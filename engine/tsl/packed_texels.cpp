#include "packed_texels.h"
#include <algorithm>
#include <tbb/parallel_for.h>

namespace lumel::tsl {
namespace {

static_assert(kGutter <= shared::kGutterReach);

// Steps within the gutters' reach, short ones first; of equal ones, in the order of rows.
std::vector<glm::ivec2> stepsByLength()
{
    std::vector<glm::ivec2> steps;
    for (int y = -shared::kGutterReach; y <= shared::kGutterReach; ++y)
        for (int x = -shared::kGutterReach; x <= shared::kGutterReach; ++x)
            steps.emplace_back(x, y);
    std::ranges::stable_sort(steps, {}, [](glm::ivec2 p) { return p.x * p.x + p.y * p.y; });
    return steps;
}

bool covered(uint32_t texel)
{
    return texel >> shared::kTexelCoverageShift != 0;
}

// One level of a map, whose texels have their coverage in 8 bits and no sources.
struct RawLevel {
    const uint32_t* texels;
    glm::ivec2 size;

    uint32_t at(glm::ivec2 p) const { return texels[size_t(p.y) * size_t(size.x) + size_t(p.x)]; }
    bool coveredAt(glm::ivec2 p) const
    {
        return p.x >= 0 && p.y >= 0 && p.x < size.x && p.y < size.y && covered(at(p));
    }
};

uint32_t packTexel(const RawLevel& level, glm::ivec2 p, const std::vector<glm::ivec2>& steps)
{
    const uint32_t texel = level.at(p), triangle = texel & shared::kTexelTriangleMask;
    if (triangle == 0)
        return 0;
    if (covered(texel)) // rounded up: covered stays covered
        return triangle | std::min(((texel >> shared::kTexelCoverageShift) + 1) / 2, shared::kFullCoverage)
                              << shared::kTexelCoverageShift;
    const auto nearest =
        std::ranges::find_if(steps, [&](glm::ivec2 step) { return level.coveredAt(p + step); });
    return shared::gutterTexel(triangle, nearest == steps.end() ? glm::ivec2(0) : *nearest);
}

} // namespace

PackedTexels pack(const TexelMap& map)
{
    const std::vector<glm::ivec2> steps = stepsByLength();
    PackedTexels packed;
    const auto tilesOf = [](glm::uvec2 size) { return (size + shared::kTileSize - 1u) / shared::kTileSize; };
    uint32_t total = 0;
    for (uint32_t level = 0; level < map.levels; ++level) {
        packed.offsets[level] = total;
        const glm::uvec2 size = map.levelSize(level), tiles = tilesOf(size);
        total += size.x * size.y + tiles.x * tiles.y;
    }
    packed.words.resize(total);
    for (uint32_t level = 0; level < map.levels; ++level) {
        const RawLevel raw{map.texels.data() + map.offsets[level], glm::ivec2(map.levelSize(level))};
        uint32_t* texels = packed.words.data() + packed.offsets[level];
        uint32_t* masks = texels + size_t(raw.size.x) * size_t(raw.size.y);
        const glm::ivec2 tiles(tilesOf(map.levelSize(level)));
        tbb::parallel_for(0, tiles.y, [&](int row) {
            std::fill_n(masks + row * tiles.x, tiles.x, shared::kAllQuads << 16u);
            const int firstLumel = row * int(shared::kTileSize);
            for (int y = firstLumel; y < std::min(firstLumel + int(shared::kTileSize), raw.size.y); ++y)
                for (int x = 0; x < raw.size.x; ++x) {
                    const uint32_t texel = packTexel(raw, {x, y}, steps);
                    texels[size_t(y) * size_t(raw.size.x) + size_t(x)] = texel;
                    const int quad = (y - firstLumel) / int(shared::kQuadSize) * 4 +
                                     x % int(shared::kTileSize) / int(shared::kQuadSize);
                    uint32_t& mask = masks[row * tiles.x + x / int(shared::kTileSize)];
                    mask |= texel ? 1u << quad : 0u;
                    mask &= ~(shared::texelCoverage(texel) < shared::kFullCoverage ? 0x10000u << quad : 0u);
                }
        });
    }
    return packed;
}

} // namespace lumel::tsl
