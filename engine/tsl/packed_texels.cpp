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

using TileTexels = std::array<uint32_t, shared::kTileLumels>; // by shared::texelPlace()

glm::uvec2 tilesOf(glm::uvec2 size)
{
    return (size + shared::kTileSize - 1u) / shared::kTileSize;
}

// Whether the tile at `first` is within the level and one covered triangle fills it, or nothing.
bool uniform(const RawLevel& level, glm::ivec2 first)
{
    constexpr int kSize = int(shared::kTileSize);
    const uint32_t texel = level.at(first);
    if ((texel != 0 && !covered(texel)) || first.x + kSize > level.size.x || first.y + kSize > level.size.y)
        return false;
    for (int y = 0; y < kSize; ++y) {
        const uint32_t* row = level.texels + size_t(first.y + y) * size_t(level.size.x) + first.x;
        uint32_t differ = 0;
        for (int x = 0; x < kSize; ++x)
            differ |= row[x] ^ texel;
        if (differ)
            return false;
    }
    return true;
}

// Beyond the level's edge, what its first lumel is.
TileTexels texelsOfTile(const RawLevel& level, glm::ivec2 first, const std::vector<glm::ivec2>& steps)
{
    TileTexels texels;
    texels.fill(packTexel(level, first, steps));
    const glm::ivec2 end = glm::min(first + int(shared::kTileSize), level.size);
    for (int y = first.y; y < end.y; ++y)
        for (int x = first.x; x < end.x; ++x)
            texels[shared::texelPlace(glm::uvec2(x, y))] = packTexel(level, {x, y}, steps);
    return texels;
}

uint32_t masksOf(const RawLevel& level, glm::ivec2 first, const TileTexels& texels)
{
    uint32_t any = 0, whole = shared::kAllQuads;
    const glm::ivec2 end = glm::min(first + int(shared::kTileSize), level.size);
    for (int y = first.y; y < end.y; ++y)
        for (int x = first.x; x < end.x; ++x) {
            const uint32_t place = shared::texelPlace(glm::uvec2(x, y)),
                           quad = 1u << place / shared::kQuadLumels;
            any |= texels[place] ? quad : 0u;
            whole &= shared::texelCoverage(texels[place]) < shared::kFullCoverage ? ~quad : ~0u;
        }
    return any | whole << 16;
}

// Appends what the tile's second word refers to, by its place in `data`.
uint32_t list(const TileTexels& texels, std::vector<uint32_t>& data)
{
    constexpr size_t kMostEntries = 16;
    const auto where = uint32_t(data.size());
    std::array<uint32_t, kMostEntries> entries;
    std::array<uint32_t, shared::kTileLumels> numbers;
    size_t count = 0;
    for (size_t place = 0; place < texels.size(); ++place) {
        const auto end = entries.begin() + ptrdiff_t(count),
                   found = std::find(entries.begin(), end, texels[place]);
        if (found == end && count == kMostEntries) {
            data.insert(data.end(), texels.begin(), texels.end());
            return shared::kTexelsListed | 3u << shared::kTexelListShift | where;
        }
        numbers[place] = uint32_t(found - entries.begin());
        if (found == end)
            entries[count++] = texels[place];
    }
    if (count == 1 && !(entries[0] & shared::kTexelsListed))
        return entries[0];
    const uint32_t head = shared::kTexelsListed | (count <= 2   ? 0u
                                                   : count <= 4 ? 1u
                                                                : 2u)
                                                      << shared::kTexelListShift;
    const uint32_t bits = shared::texelListBits(head);
    data.resize(where + 2 * bits, 0);
    for (uint32_t place = 0; place < numbers.size(); ++place)
        data[where + place * bits / 32] |= numbers[place] << place * bits % 32;
    data.insert(data.end(), entries.begin(), entries.begin() + ptrdiff_t(count));
    return head | where;
}

// One row of a level's tiles: two words each, and what the second ones refer to.
struct PackedRow {
    uint32_t level = 0, first = 0; // of its words in the packed map
    int row = 0;
    std::vector<uint32_t> tiles, data;
};

void packRow(const RawLevel& level, PackedRow& result, const std::vector<glm::ivec2>& steps)
{
    for (glm::ivec2 first(0, result.row * int(shared::kTileSize)); first.x < level.size.x;
         first.x += int(shared::kTileSize)) {
        if (uniform(level, first)) {
            TileTexels texels;
            texels.fill(packTexel(level, first, steps));
            result.tiles.insert(result.tiles.end(), {masksOf(level, first, texels), texels[0]});
            continue;
        }
        const TileTexels texels = texelsOfTile(level, first, steps);
        result.tiles.insert(result.tiles.end(), {masksOf(level, first, texels), list(texels, result.data)});
    }
}

// Moves a row to its place in the map, with its data from word `where` on.
void place(PackedRow& row, uint32_t where, UninitialisedArray<uint32_t>& words)
{
    for (size_t i = 1; i < row.tiles.size(); i += 2)
        row.tiles[i] += row.tiles[i] & shared::kTexelsListed ? where : 0u;
    std::ranges::copy(row.tiles, words.begin() + row.first);
    std::ranges::copy(row.data, words.begin() + where);
    row = {};
}

} // namespace

PackedTexels pack(const TexelMap& map)
{
    const std::vector<glm::ivec2> steps = stepsByLength();
    PackedTexels packed;
    std::vector<PackedRow> rows;
    uint32_t total = 0;
    for (uint32_t level = 0; level < map.levels; ++level) {
        packed.offsets[level] = total;
        const glm::uvec2 tiles = tilesOf(map.levelSize(level));
        for (uint32_t row = 0; row < tiles.y; ++row, total += 2 * tiles.x)
            rows.push_back({.level = level, .first = total, .row = int(row), .tiles = {}, .data = {}});
    }
    tbb::parallel_for(size_t(0), rows.size(), [&](size_t i) {
        const uint32_t level = rows[i].level;
        packRow({map.texels.data() + map.offsets[level], glm::ivec2(map.levelSize(level))}, rows[i], steps);
    });
    std::vector<uint32_t> where;
    for (const PackedRow& row : rows) {
        where.push_back(total);
        total += uint32_t(row.data.size());
    }
    packed.words.resize(total);
    tbb::parallel_for(size_t(0), rows.size(), [&](size_t i) { place(rows[i], where[i], packed.words); });
    return packed;
}

} // namespace lumel::tsl
