#include "texel_map.h"
#include "core/error.h"
#include <bit>
#include <fmt/format.h>
#include <functional>
#include <numeric>
#include <tbb/parallel_for.h>

namespace lumel::tsl {
namespace {

using shared::kTexelCoverageShift;
using shared::kTexelTriangleMask;

constexpr uint32_t kBandRows = 64; // rows that one task works on
constexpr uint32_t kCovered = 255u << kTexelCoverageShift;
constexpr double kChartGap = 4.0; // lumels: the taps of a cubic filter reach 2 across either chart's border

void forBands(uint32_t rows, const std::function<void(uint32_t, uint32_t)>& work)
{
    tbb::parallel_for(uint32_t(0), (rows + kBandRows - 1) / kBandRows,
                      [&](uint32_t band) { work(band * kBandRows, std::min((band + 1) * kBandRows, rows)); });
}

// One side of a triangle: lumel centres on it or to its left are inside. In double: lumel coordinates reach
// 8192 and products of differences need more than float's 24 bits.
struct Edge {
    glm::dvec2 from, along;
    double slope; // columns a row; 0 where it is level, or nearly

    Edge(glm::dvec2 p, glm::dvec2 q)
        : from(p), along(q - p), slope(std::abs(along.y) > 1e-9 ? along.x / along.y : 0.0)
    {
    }
    double left(glm::dvec2 p) const { return along.x * (p.y - from.y) - along.y * (p.x - from.x); }
    bool holds(int x, double y) const { return left({x + 0.5, y}) >= 0.0; }

    // Narrows lumels [first, last] of the row with centres at height y to those inside. Each operation of
    // left() is monotonic in x as it is rounded, so that these are a prefix or a suffix: where it ends is
    // estimated, then checked.
    void clip(double y, int& first, int& last) const
    {
        const double crossing = from.x + slope * (y - from.y) - 0.5;
        int low = int(std::clamp(std::floor(crossing), first - 1.0, double(last)));
        const bool before = holds(low, y);
        if (before == holds(low + 1, y))
            search(y, first, last);
        else if (before)
            last = std::min(last, low);
        else
            first = std::max(first, low + 1);
    }

    void search(double y, int& first, int& last) const
    {
        const bool begins = holds(first, y), ends = holds(last, y);
        if (begins == ends) {
            if (!begins)
                last = first - 1;
            return;
        }
        int low = first, high = last; // on either side of the crossing
        while (high - low > 1) {
            const int middle = (low + high) / 2;
            (holds(middle, y) == begins ? low : high) = middle;
        }
        begins ? last = low : first = high;
    }
};

using Corners = std::array<glm::dvec2, 3>; // in lumels

Corners cornersOf(const scene::Mesh& mesh, size_t triangle, glm::uvec2 size)
{
    Corners corners;
    for (size_t k = 0; k < 3; ++k)
        corners[k] = glm::dvec2(mesh.vertices[mesh.indices[3 * triangle + k]].uv) * glm::dvec2(size);
    return corners;
}

// Writes `value` to every lumel of rows [row0, row1) whose centre lies in the triangle.
void rasterise(const Corners& corners, uint32_t value, glm::uvec2 size, uint32_t row0, uint32_t row1,
               uint32_t* texels)
{
    auto [a, b, c] = corners;
    const double area = Edge(a, b).left(c);
    if (area == 0.0)
        return;
    if (area < 0.0)
        std::swap(b, c);
    const Edge edges[] = {{a, b}, {b, c}, {c, a}};
    const auto lower = glm::max(glm::floor(glm::min(glm::min(a, b), c) - 0.5), glm::dvec2(0.0, row0));
    const auto upper = glm::min(glm::ceil(glm::max(glm::max(a, b), c)), glm::dvec2(size.x, row1) - 1.0);
    for (int y = int(lower.y); y <= int(upper.y); ++y) {
        int first = int(lower.x), last = int(upper.x);
        for (const Edge& edge : edges)
            if (first <= last)
                edge.clip(y + 0.5, first, last);
        if (first <= last)
            std::fill_n(texels + size_t(y) * size.x + first, last - first + 1, value);
    }
}

// The triangles that may touch each band of rows, in order: a list of bands' first entries and the entries.
struct Bins {
    std::vector<uint32_t> first, triangles;
};

Bins binTriangles(const scene::Mesh& mesh, glm::uvec2 size)
{
    const int bands = int((size.y + kBandRows - 1) / kBandRows);
    const auto forEachBand = [&](size_t triangle, const auto& work) {
        const Corners p = cornersOf(mesh, triangle, size);
        const double top = std::min({p[0].y, p[1].y, p[2].y}) / kBandRows;
        const double bottom = std::max({p[0].y, p[1].y, p[2].y}) / kBandRows;
        // What ends on the border of two bands is in both.
        const int last = std::min(int(std::floor(bottom)), bands - 1);
        for (int band = std::max(int(std::ceil(top)) - 1, 0); band <= last; ++band)
            work(size_t(band));
    };
    Bins bins;
    bins.first.assign(size_t(bands) + 1, 0);
    const size_t count = mesh.indices.size() / 3;
    for (size_t i = 0; i < count; ++i)
        forEachBand(i, [&](size_t band) { ++bins.first[band + 1]; });
    std::partial_sum(bins.first.begin(), bins.first.end(), bins.first.begin());
    bins.triangles.resize(bins.first.back());
    std::vector<uint32_t> next(bins.first.begin(), bins.first.end() - 1);
    for (size_t i = 0; i < count; ++i)
        forEachBand(i, [&](size_t band) { bins.triangles[next[band]++] = uint32_t(i); });
    return bins;
}

// `flags` go into every lumel that is hit.
void rasteriseLevel(const scene::Mesh& mesh, glm::uvec2 size, uint32_t flags, uint32_t* texels)
{
    const Bins bins = binTriangles(mesh, size);
    // Each band goes through its triangles in order: the result does not depend on the number of threads.
    forBands(size.y, [&](uint32_t row0, uint32_t row1) {
        std::fill(texels + size_t(row0) * size.x, texels + size_t(row1) * size.x, 0u);
        const uint32_t band = row0 / kBandRows;
        for (uint32_t i = bins.first[band]; i < bins.first[band + 1]; ++i) {
            const uint32_t triangle = bins.triangles[i];
            rasterise(cornersOf(mesh, triangle, size), (triangle + 1) | flags, size, row0, row1, texels);
        }
    });
}

// A chart so small that it lies between lumel centres would stay dark: its triangles take the lumel that
// their centre lies in, where no surface is near.
void placeStrays(const scene::Mesh& mesh, glm::uvec2 size, uint32_t* texels)
{
    const glm::ivec2 last = glm::ivec2(size) - 1;
    for (size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        const Corners p = cornersOf(mesh, i / 3, size);
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
            texels[size_t(at.y) * size.x + size_t(at.x)] = uint32_t(i / 3 + 1) | kCovered;
    }
}

// Coverage of a coarser level is the mean of its children's, kColumns x kRows of them; a lumel whose own
// centre misses every chart takes the triangle of its most covered child.
template<uint32_t kColumns, uint32_t kRows>
void coverFromChildren(const uint32_t* fine, uint32_t* coarse, glm::uvec2 size)
{
    forBands(size.y, [&](uint32_t row0, uint32_t row1) {
        for (uint32_t y = row0; y < row1; ++y)
            for (uint32_t x = 0; x < size.x; ++x) {
                uint32_t sum = 0, best = 0;
                for (uint32_t j = 0; j < kRows; ++j)
                    for (uint32_t i = 0; i < kColumns; ++i) {
                        const uint32_t child =
                            fine[size_t(y * kRows + j) * size.x * kColumns + x * kColumns + i];
                        const uint32_t coverage = child >> kTexelCoverageShift;
                        sum += coverage;
                        if (coverage > best >> kTexelCoverageShift)
                            best = child;
                    }
                constexpr uint32_t count = kColumns * kRows;
                const uint32_t coverage = (sum + count - 1) / count; // rounded up: covered stays covered
                uint32_t& texel = coarse[size_t(y) * size.x + x];
                const uint32_t triangle = (texel & kTexelTriangleMask) && coverage ? texel : best;
                texel = coverage ? (triangle & kTexelTriangleMask) | coverage << kTexelCoverageShift : 0u;
            }
    });
}

void coverFromChildren(const uint32_t* fine, glm::uvec2 fineSize, uint32_t* coarse, glm::uvec2 size)
{
    if (fineSize.y == size.y)
        coverFromChildren<2, 1>(fine, coarse, size);
    else if (fineSize.x == size.x)
        coverFromChildren<1, 2>(fine, coarse, size);
    else
        coverFromChildren<2, 2>(fine, coarse, size);
}

// One bit a lumel.
struct Mask {
    glm::uvec2 size{0};
    uint32_t words = 0; // a row
    std::vector<uint64_t> bits;

    explicit Mask(glm::uvec2 lumels)
        : size(lumels), words((lumels.x + 63) / 64), bits(size_t(words) * lumels.y)
    {
    }
    bool at(int x, int y) const
    {
        return x >= 0 && y >= 0 && x < int(size.x) && y < int(size.y) &&
               (word(uint32_t(y), uint32_t(x) / 64) >> (x % 64) & 1);
    }
    // 0 outside: row or i may be -1 as an unsigned number.
    uint64_t word(uint32_t row, uint32_t i) const
    {
        return row < size.y && i < words ? bits[size_t(row) * words + i] : 0;
    }
};

Mask filledOf(const uint32_t* texels, glm::uvec2 size)
{
    Mask mask(size);
    forBands(size.y, [&](uint32_t row0, uint32_t row1) {
        for (uint32_t y = row0; y < row1; ++y)
            for (uint32_t x = 0; x < size.x; ++x)
                mask.bits[size_t(y) * mask.words + x / 64] |= uint64_t(texels[size_t(y) * size.x + x] != 0)
                                                              << (x % 64);
    });
    return mask;
}

// The lumels that are not in the mask but have one of their eight neighbours there.
Mask ringAround(const Mask& mask)
{
    Mask ring(mask.size);
    const uint64_t lastWord = ~uint64_t(0) >> (63 - (mask.size.x - 1) % 64);
    forBands(mask.size.y, [&](uint32_t row0, uint32_t row1) {
        for (uint32_t y = row0; y < row1; ++y) {
            const auto column = [&](uint32_t i) {
                return mask.word(y - 1, i) | mask.word(y, i) | mask.word(y + 1, i);
            };
            for (uint32_t i = 0; i < mask.words; ++i) {
                const uint64_t own = column(i);
                const uint64_t wide = own | own << 1 | own >> 1 | column(i - 1) >> 63 | column(i + 1) << 63;
                ring.bits[size_t(y) * mask.words + i] =
                    wide & ~mask.word(y, i) & (i + 1 == mask.words ? lastWord : ~uint64_t(0));
            }
        }
    });
    return ring;
}

// Lumels of the ring around those that are filled take the triangle of such a neighbour, straight ones first.
void fillRing(uint32_t* texels, const Mask& filled, const Mask& ring)
{
    constexpr int kNeighbours[8][2] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}, {-1, -1}, {1, -1}, {-1, 1}, {1, 1}};
    const auto fill = [&](int x, int y) {
        for (const auto& [dx, dy] : kNeighbours)
            if (filled.at(x + dx, y + dy)) {
                texels[size_t(y) * filled.size.x + size_t(x)] =
                    texels[size_t(y + dy) * filled.size.x + size_t(x + dx)] & kTexelTriangleMask;
                return;
            }
    };
    forBands(ring.size.y, [&](uint32_t row0, uint32_t row1) {
        for (uint32_t y = row0; y < row1; ++y)
            for (uint32_t i = 0; i < ring.words; ++i)
                for (uint64_t rest = ring.word(y, i); rest; rest &= rest - 1)
                    fill(int(i) * 64 + std::countr_zero(rest), int(y));
    });
}

void addGutters(uint32_t* texels, glm::uvec2 size)
{
    Mask filled = filledOf(texels, size);
    for (int i = 0; i < kGutter; ++i) {
        const Mask ring = ringAround(filled);
        fillRing(texels, filled, ring);
        for (size_t word = 0; word < ring.bits.size(); ++word)
            filled.bits[word] |= ring.bits[word];
    }
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
    map.texels.resize(total);
    for (uint32_t level = 0; level < map.levels; ++level) {
        uint32_t* texels = map.texels.data() + map.offsets[level];
        const glm::uvec2 levelSize = map.levelSize(level);
        rasteriseLevel(mesh, levelSize, level == 0 ? kCovered : 0, texels);
        if (level == 0)
            placeStrays(mesh, levelSize, texels);
        else
            coverFromChildren(map.texels.data() + map.offsets[level - 1], map.levelSize(level - 1), texels,
                              levelSize);
    }
    // After all coverage is known, since gutters carry none.
    for (uint32_t level = 0; level < map.levels; ++level)
        addGutters(map.texels.data() + map.offsets[level], map.levelSize(level));
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
