#include "texel_map.h"
#include "core/error.h"
#include <bit>
#include <fmt/format.h>
#include <functional>
#include <tbb/parallel_for.h>

namespace lumel::tsl {
namespace {

using shared::kTexelCoverageShift;
using shared::kTexelTriangleMask;

constexpr uint32_t kBandRows = 64; // rows that one task works on
constexpr double kChartGap = 4.0;  // lumels: the taps of a cubic filter reach 2 across either chart's border

// Writes `value` to every lumel of rows [row0, row1) whose centre lies in the triangle. Edge functions in
// double: lumel coordinates reach 8192 and products of differences need more than float's 24 bits.
void rasterise(const std::array<glm::dvec2, 3>& corners, uint32_t value, glm::uvec2 size, uint32_t row0,
               uint32_t row1, uint32_t* texels)
{
    auto [a, b, c] = corners;
    const auto edge = [](glm::dvec2 p, glm::dvec2 q, glm::dvec2 r) {
        return (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
    };
    const double area = edge(a, b, c);
    if (area == 0.0)
        return;
    if (area < 0.0)
        std::swap(b, c);
    const auto lower = glm::max(glm::floor(glm::min(glm::min(a, b), c) - 0.5), glm::dvec2(0.0, row0));
    const auto upper = glm::min(glm::ceil(glm::max(glm::max(a, b), c)), glm::dvec2(size.x, row1) - 1.0);
    for (int y = int(lower.y); y <= int(upper.y); ++y)
        for (int x = int(lower.x); x <= int(upper.x); ++x) {
            const glm::dvec2 p(x + 0.5, y + 0.5);
            if (edge(a, b, p) >= 0.0 && edge(b, c, p) >= 0.0 && edge(c, a, p) >= 0.0)
                texels[size_t(y) * size.x + x] = value;
        }
}

void forBands(uint32_t rows, const std::function<void(uint32_t, uint32_t)>& work)
{
    tbb::parallel_for(uint32_t(0), (rows + kBandRows - 1) / kBandRows,
                      [&](uint32_t band) { work(band * kBandRows, std::min((band + 1) * kBandRows, rows)); });
}

void rasteriseLevel(const scene::Mesh& mesh, glm::uvec2 size, uint32_t* texels)
{
    const glm::dvec2 scale(size);
    // Each band goes through all triangles in order: the result does not depend on the number of threads.
    forBands(size.y, [&](uint32_t row0, uint32_t row1) {
        for (size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
            std::array<glm::dvec2, 3> corners;
            for (size_t k = 0; k < 3; ++k)
                corners[k] = glm::dvec2(mesh.vertices[mesh.indices[i + k]].uv) * scale;
            const double top = std::min({corners[0].y, corners[1].y, corners[2].y});
            const double bottom = std::max({corners[0].y, corners[1].y, corners[2].y});
            if (bottom >= row0 && top <= row1)
                rasterise(corners, uint32_t(i / 3 + 1), size, row0, row1, texels);
        }
    });
}

// A chart so small that it lies between lumel centres would stay dark: its triangles take the lumel that
// their centre lies in, where no surface is near.
void placeStrays(const scene::Mesh& mesh, glm::uvec2 size, uint32_t* texels)
{
    const glm::ivec2 last = glm::ivec2(size) - 1;
    for (size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        std::array<glm::dvec2, 3> p;
        for (size_t k = 0; k < 3; ++k)
            p[k] = glm::dvec2(mesh.vertices[mesh.indices[i + k]].uv) * glm::dvec2(size);
        const glm::dvec2 ab = p[1] - p[0], ac = p[2] - p[0];
        const double area = std::abs(ab.x * ac.y - ab.y * ac.x);
        // Larger ones than this have a centre inside unless they are slivers.
        if (area == 0.0 || std::max({glm::length(ab), glm::length(ac), glm::length(ab - ac)}) > 4.0)
            continue;
        const glm::ivec2 at = glm::clamp(glm::ivec2((p[0] + p[1] + p[2]) / 3.0), glm::ivec2(0), last);
        bool alone = true;
        for (int y = std::max(at.y - 1, 0); y <= std::min(at.y + 1, last.y); ++y)
            for (int x = std::max(at.x - 1, 0); x <= std::min(at.x + 1, last.x); ++x)
                alone = alone && texels[size_t(y) * size.x + size_t(x)] == 0;
        if (alone)
            texels[size_t(at.y) * size.x + size_t(at.x)] = uint32_t(i / 3 + 1);
    }
}

// Coverage of a coarser level is the mean of its children's; a lumel whose own centre misses every chart
// takes the triangle of its most covered child.
void coverFromChildren(const uint32_t* fine, glm::uvec2 fineSize, uint32_t* coarse, glm::uvec2 size)
{
    const glm::uvec2 ratio = fineSize / size;
    forBands(size.y, [&](uint32_t row0, uint32_t row1) {
        for (uint32_t y = row0; y < row1; ++y)
            for (uint32_t x = 0; x < size.x; ++x) {
                uint32_t sum = 0, best = 0;
                for (uint32_t j = 0; j < ratio.y; ++j)
                    for (uint32_t i = 0; i < ratio.x; ++i) {
                        const uint32_t child = fine[size_t(y * ratio.y + j) * fineSize.x + x * ratio.x + i];
                        const uint32_t coverage = child >> kTexelCoverageShift;
                        sum += coverage;
                        if (coverage > best >> kTexelCoverageShift)
                            best = child;
                    }
                const uint32_t count = ratio.x * ratio.y;
                const uint32_t coverage = (sum + count - 1) / count; // rounded up: covered stays covered
                uint32_t& texel = coarse[size_t(y) * size.x + x];
                const uint32_t triangle = (texel & kTexelTriangleMask) && coverage ? texel : best;
                texel = coverage ? (triangle & kTexelTriangleMask) | coverage << kTexelCoverageShift : 0u;
            }
    });
}

// One ring of gutter: empty lumels take the triangle of a neighbour, straight ones first.
void dilate(uint32_t* texels, glm::uvec2 size, std::vector<uint32_t>& scratch)
{
    scratch.assign(texels, texels + size_t(size.x) * size.y);
    constexpr int kNeighbours[8][2] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}, {-1, -1}, {1, -1}, {-1, 1}, {1, 1}};
    forBands(size.y, [&](uint32_t row0, uint32_t row1) {
        for (int y = int(row0); y < int(row1); ++y)
            for (int x = 0; x < int(size.x); ++x) {
                if (scratch[size_t(y) * size.x + x])
                    continue;
                for (const auto& [dx, dy] : kNeighbours) {
                    const int nx = x + dx, ny = y + dy;
                    if (nx < 0 || ny < 0 || nx >= int(size.x) || ny >= int(size.y))
                        continue;
                    if (const uint32_t found = scratch[size_t(ny) * size.x + nx] & kTexelTriangleMask) {
                        texels[size_t(y) * size.x + x] = found;
                        break;
                    }
                }
            }
    });
}

} // namespace

TexelMap makeTexelMap(const scene::Mesh& mesh, glm::uvec2 size)
{
    if (mesh.indices.size() / 3 >= kTexelTriangleMask)
        throw Error(
            fmt::format("mesh {}: more than {} triangles; split it", mesh.name, kTexelTriangleMask - 1));
    TexelMap map;
    map.size = size;
    map.levels = uint32_t(std::bit_width(std::max(size.x, size.y)));
    uint32_t total = 0;
    for (uint32_t level = 0; level < map.levels; ++level) {
        map.offsets[level] = total;
        total += map.levelSize(level).x * map.levelSize(level).y;
    }
    map.texels.assign(total, 0);
    for (uint32_t level = 0; level < map.levels; ++level) {
        uint32_t* texels = map.texels.data() + map.offsets[level];
        const glm::uvec2 levelSize = map.levelSize(level);
        rasteriseLevel(mesh, levelSize, texels);
        if (level == 0) {
            placeStrays(mesh, levelSize, texels);
            for (size_t i = 0; i < size_t(levelSize.x) * levelSize.y; ++i)
                if (texels[i])
                    texels[i] |= 255u << kTexelCoverageShift;
        } else {
            coverFromChildren(map.texels.data() + map.offsets[level - 1], map.levelSize(level - 1), texels,
                              levelSize);
        }
    }
    // After all coverage is known, since gutters carry none.
    std::vector<uint32_t> scratch;
    for (uint32_t level = 0; level < map.levels; ++level)
        for (int ring = 0; ring < kGutter; ++ring)
            dilate(map.texels.data() + map.offsets[level], map.levelSize(level), scratch);
    return map;
}

glm::uvec2 lumelGrid(glm::ivec2 material, glm::ivec2 emissive)
{
    const auto grid = [](int texels, int emissiveTexels) {
        const auto next = [](int n) { return std::bit_ceil(uint32_t(std::max(n, 1))); };
        return std::clamp(std::max(2u * next(texels), next(emissiveTexels)), kMinGrid, kMaxGrid);
    };
    return {grid(material.x, emissive.x), grid(material.y, emissive.y)};
}

glm::uvec2 lumelGrid(const scene::Mesh& mesh, glm::ivec2 material, glm::ivec2 emissive)
{
    double texels = 0.0, emissiveTexels = 0.0, lit = 0.0; // areas: of the maps in texels, of the lit texture
    const auto area = [](glm::dvec2 a, glm::dvec2 b, glm::dvec2 c) {
        return 0.5 * std::abs((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x));
    };
    for (size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        const auto &a = mesh.vertices[mesh.indices[i]], &b = mesh.vertices[mesh.indices[i + 1]],
                   &c = mesh.vertices[mesh.indices[i + 2]];
        texels += area(a.materialUv, b.materialUv, c.materialUv) * material.x * material.y;
        emissiveTexels += area(a.emissionUv, b.emissionUv, c.emissionUv) * emissive.x * emissive.y;
        lit += area(a.uv, b.uv, c.uv);
    }
    const double across = lit > 0.0 ? std::sqrt(std::max(4.0 * texels, emissiveTexels) / lit) : 0.0;
    const double clear = mesh.unwrapped ? kChartGap / std::max(double(mesh.unwrapped->gap), 1e-9) : 0.0;
    const double power =
        std::max(std::round(std::log2(std::max(across, 1.0))), std::ceil(std::log2(std::max(clear, 1.0))));
    return glm::uvec2(uint32_t(std::clamp(std::exp2(power), double(kMinGrid), double(kMaxOwnGrid))));
}

} // namespace lumel::tsl
