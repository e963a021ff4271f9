#include "chart_levels.h"
#include <algorithm>
#include <numeric>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>
#include <tuple>

namespace lumel::tsl {
namespace {

constexpr uint32_t kNone = 0, kSeveral = ~0u; // instead of a chart's number

uint32_t rootOf(std::vector<uint32_t>& parents, uint32_t i)
{
    while (parents[i] != i)
        i = parents[i] = parents[parents[i]];
    return i;
}

// Per triangle, a number from 1 that its chart's triangles share.
std::vector<uint32_t> chartsOf(const scene::Mesh& mesh)
{
    const auto key = [&](uint32_t vertex) {
        const shared::Vertex& v = mesh.vertices[vertex];
        return std::tuple(v.position.x, v.position.y, v.position.z, v.uv.x, v.uv.y);
    };
    std::vector<uint32_t> order(mesh.vertices.size()), parents(mesh.vertices.size());
    std::iota(order.begin(), order.end(), 0u);
    std::iota(parents.begin(), parents.end(), 0u);
    std::ranges::sort(order, [&](uint32_t a, uint32_t b) { return key(a) < key(b); });
    for (size_t i = 1; i < order.size(); ++i)
        if (key(order[i]) == key(order[i - 1]))
            parents[rootOf(parents, order[i])] = rootOf(parents, order[i - 1]);
    for (size_t i = 0; i + 2 < mesh.indices.size(); i += 3)
        for (size_t k = 1; k < 3; ++k)
            parents[rootOf(parents, mesh.indices[i + k])] = rootOf(parents, mesh.indices[i]);
    std::vector<uint32_t> charts(mesh.indices.size() / 3);
    for (size_t i = 0; i < charts.size(); ++i)
        charts[i] = rootOf(parents, mesh.indices[3 * i]) + 1;
    return charts;
}

// A level's charts, one number a lumel.
struct ChartLevel {
    glm::uvec2 size{0};
    UninitialisedArray<uint32_t> charts;

    uint32_t at(int x, int y) const
    {
        const bool inside = x >= 0 && y >= 0 && x < int(size.x) && y < int(size.y);
        return inside ? charts[size_t(y) * size.x + size_t(x)] : kNone;
    }
    bool seam(int x, int y) const
    {
        const uint32_t own = at(x, y);
        const bool inside = x > 0 && y > 0 && x + 1 < int(size.x) && y + 1 < int(size.y);
        const uint32_t* const middle = charts.data() + size_t(y) * size.x + size_t(x);
        bool mixed = own == kSeveral;
        for (int j = -1; j <= 1; ++j)
            for (int i = -1; i <= 1; ++i) {
                const uint32_t other = inside ? middle[j * int(size.x) + i] : at(x + i, y + j);
                mixed |= (other != kNone) & (other != own);
            }
        return mixed;
    }
};

float seamShare(const ChartLevel& level)
{
    using Counts = std::pair<size_t, size_t>; // seams, covered lumels
    const Counts counts = tbb::parallel_reduce(
        tbb::blocked_range<int>(0, int(level.size.y), 32), Counts{},
        [&](const auto& rows, Counts sum) {
            for (int y = rows.begin(); y < rows.end(); ++y)
                for (int x = 0; x < int(level.size.x); ++x)
                    if (level.at(x, y) != kNone) {
                        ++sum.second;
                        sum.first += level.seam(x, y);
                    }
            return sum;
        },
        [](const Counts& a, const Counts& b) { return Counts(a.first + b.first, a.second + b.second); });
    return float(double(counts.first) / double(std::max<size_t>(counts.second, 1)));
}

ChartLevel coarser(const ChartLevel& fine)
{
    ChartLevel level{glm::max(fine.size / 2u, glm::uvec2(1)), {}};
    const glm::uvec2 ratio = fine.size / level.size;
    level.charts.resize(size_t(level.size.x) * level.size.y);
    tbb::parallel_for(0u, level.size.y, [&](uint32_t y) {
        for (uint32_t x = 0; x < level.size.x; ++x) {
            uint32_t chart = kNone;
            for (uint32_t j = 0; j < ratio.y; ++j)
                for (uint32_t i = 0; i < ratio.x; ++i) {
                    const uint32_t child = fine.at(int(x * ratio.x + i), int(y * ratio.y + j));
                    if (child != kNone)
                        chart = chart == kNone || chart == child ? child : kSeveral;
                }
            level.charts[size_t(y) * level.size.x + x] = chart;
        }
    });
    return level;
}

} // namespace

std::vector<float> seamShares(const scene::Mesh& mesh, const TexelMap& map)
{
    const std::vector<uint32_t> charts = chartsOf(mesh);
    if (charts.empty() || std::ranges::all_of(charts, [&](uint32_t c) { return c == charts[0]; }))
        return std::vector<float>(map.levels, 0.0f);
    ChartLevel level{map.size, UninitialisedArray<uint32_t>(size_t(map.size.x) * map.size.y)};
    tbb::parallel_for(tbb::blocked_range<size_t>(0, level.charts.size(), 65536), [&](const auto& range) {
        for (size_t i = range.begin(); i < range.end(); ++i) {
            const uint32_t texel = map.texels[i];
            level.charts[i] = texel >> shared::kTexelCoverageShift
                                  ? charts[(texel & shared::kTexelTriangleMask) - 1]
                                  : kNone;
        }
    });
    std::vector<float> shares;
    for (uint32_t i = 0; i < map.levels; ++i) {
        if (i > 0)
            level = coarser(level);
        shares.push_back(seamShare(level));
    }
    return shares;
}

uint32_t coarsestWithoutSeams(const std::vector<float>& shares)
{
    const auto first = std::ranges::find_if(shares, [](float share) { return share > kSeamsBearable; });
    return uint32_t(std::max<std::ptrdiff_t>(first - shares.begin(), 1) - 1);
}

} // namespace lumel::tsl
