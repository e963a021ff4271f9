// Charts grow from the largest triangles over neighbours whose normals stay near the chart's mean (Sander et
// al. 2001, "Texture Mapping Progressive Meshes", use the same cone), then small ones join neighbours where
// the cone allows it, then what folds over itself on its plane is halved until nothing does. Plane projection
// is the simplest mapping with a stretch that is known beforehand; conformal ones (Levy et al. 2002) give
// fewer charts, but a density that is not bounded.
#include "charts.h"
#include <map>
#include <numbers>
#include <numeric>

namespace lumel::scene {
namespace {

using Vec3 = glm::dvec3;

constexpr uint32_t kNone = ~0u;
constexpr double kGrowCosine = 0.82; // 35 degrees from the running mean: leaves room for the mean to move

Vec3 unit(Vec3 v)
{
    const double length = glm::length(v);
    return length > 0.0 ? v / length : Vec3(0.0);
}

// One number for each distinct position: charts grow across vertices that were split for other attributes.
std::vector<uint32_t> weldPositions(const Mesh& mesh)
{
    std::vector<uint32_t> order(mesh.vertices.size());
    std::iota(order.begin(), order.end(), 0u);
    const auto key = [&](uint32_t i) {
        const glm::vec3 p = mesh.vertices[i].position;
        return std::array<float, 3>{p.x, p.y, p.z};
    };
    std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return key(a) < key(b); });
    std::vector<uint32_t> welded(order.size());
    for (size_t i = 0; i < order.size(); ++i)
        welded[order[i]] = i > 0 && key(order[i]) == key(order[i - 1]) ? welded[order[i - 1]] : order[i];
    return welded;
}

// Corners in the plane of `axis`, in metres from the first one.
std::vector<FlatTriangle> project(const Mesh& mesh, const Chart& chart)
{
    const Vec3 n = chart.axis;
    const Vec3 u = unit(std::abs(n.x) < 0.9 ? glm::cross(Vec3(1, 0, 0), n) : glm::cross(Vec3(0, 1, 0), n));
    const Vec3 v = glm::cross(n, u);
    const Vec3 origin = mesh.vertices[mesh.indices[3 * chart.triangles.front()]].position;
    std::vector<FlatTriangle> flat;
    flat.reserve(chart.triangles.size());
    for (uint32_t t : chart.triangles) {
        FlatTriangle corners;
        for (size_t c = 0; c < 3; ++c) {
            const Vec3 p = Vec3(mesh.vertices[mesh.indices[3 * t + c]].position) - origin;
            corners[c] = {glm::dot(p, u), glm::dot(p, v)};
        }
        flat.push_back(corners);
    }
    return flat;
}

// Does the chart, projected, lie on itself anywhere? Brought to size 1 for the test's tolerances.
bool folds(const Mesh& mesh, const Chart& chart)
{
    std::vector<FlatTriangle> flat = project(mesh, chart);
    double extent = 0.0;
    for (const FlatTriangle& t : flat)
        for (const glm::dvec2 p : t)
            extent = std::max({extent, std::abs(p.x), std::abs(p.y)});
    for (FlatTriangle& t : flat)
        for (glm::dvec2& p : t)
            p /= extent;
    return anyOverlap(flat);
}

class ChartCutter {
public:
    explicit ChartCutter(const Mesh& mesh)
        : mesh_(mesh), count_(mesh.indices.size() / 3), area_(count_), normal_(count_),
          neighbours_(count_, {kNone, kNone, kNone}), chartOf_(count_, kNone)
    {
        for (size_t t = 0; t < count_; ++t) {
            const Vec3 across = glm::cross(corner(t, 1) - corner(t, 0), corner(t, 2) - corner(t, 0));
            area_[t] = 0.5 * glm::length(across);
            normal_[t] = unit(across);
        }
        findNeighbours();
    }

    std::vector<Chart> cut()
    {
        growAll();
        for (int pass = 0; pass < kMostMergePasses && mergeSmall(); ++pass)
            ;
        splitFolds();
        return std::move(charts_);
    }

private:
    static constexpr int kMostMergePasses = 8;

    Vec3 corner(size_t t, size_t c) const { return mesh_.vertices[mesh_.indices[3 * t + c]].position; }

    void findNeighbours();
    void growAll();
    void growFrom(uint32_t seed);
    bool mergeSmall();
    bool tryMerge(uint32_t small);
    void splitFolds();
    Vec3 weightedNormal(const std::vector<uint32_t>& triangles) const
    {
        Vec3 sum(0.0);
        for (uint32_t t : triangles)
            sum += area_[t] * normal_[t];
        return sum;
    }
    bool within(const std::vector<uint32_t>& triangles, Vec3 axis) const
    {
        return std::all_of(triangles.begin(), triangles.end(),
                           [&](uint32_t t) { return glm::dot(normal_[t], axis) >= kLeastCosine; });
    }
    std::vector<std::vector<uint32_t>> connectedParts(std::span<const uint32_t> triangles);

    const Mesh& mesh_;
    size_t count_;
    std::vector<double> area_;
    std::vector<Vec3> normal_;
    std::vector<std::array<uint32_t, 3>> neighbours_; // across the edge from corner c to c + 1
    std::vector<uint32_t> chartOf_;
    std::vector<Chart> charts_;
};

// Triangles meet where their edges run opposite ways. Where more than two share an edge (copies of a surface
// on top of each other) the first of either direction go together, then the second, and so on.
void ChartCutter::findNeighbours()
{
    const std::vector<uint32_t> welded = weldPositions(mesh_);
    struct Edge {
        uint64_t key; // of both directions
        bool forwards;
        uint32_t slot; // 3 * triangle + corner
    };
    std::vector<Edge> edges;
    edges.reserve(3 * count_);
    for (uint32_t t = 0; t < count_; ++t)
        for (uint32_t c = 0; c < 3 && area_[t] > 0.0; ++c) {
            const uint64_t a = welded[mesh_.indices[3 * t + c]];
            const uint64_t b = welded[mesh_.indices[3 * t + (c + 1) % 3]];
            edges.push_back({std::min(a, b) << 32 | std::max(a, b), a < b, 3 * t + c});
        }
    std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
        return std::tie(a.key, a.forwards, a.slot) < std::tie(b.key, b.forwards, b.slot);
    });
    for (size_t first = 0; first < edges.size();) {
        size_t middle = first, last = first;
        while (last < edges.size() && edges[last].key == edges[first].key)
            middle += !edges[last++].forwards;
        for (size_t i = first, j = middle; i < middle && j < last; ++i, ++j) {
            neighbours_[edges[i].slot / 3][edges[i].slot % 3] = edges[j].slot / 3;
            neighbours_[edges[j].slot / 3][edges[j].slot % 3] = edges[i].slot / 3;
        }
        first = last;
    }
}

void ChartCutter::growAll()
{
    std::vector<uint32_t> order;
    for (uint32_t t = 0; t < count_; ++t)
        if (area_[t] > 0.0)
            order.push_back(t);
    std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return area_[a] > area_[b]; });
    // A chart lets go again of what its final mean leaves out; each round places a triangle at least.
    while (!order.empty()) {
        for (uint32_t t : order)
            if (chartOf_[t] == kNone)
                growFrom(t);
        std::erase_if(order, [&](uint32_t t) { return chartOf_[t] != kNone; });
    }
}

void ChartCutter::growFrom(uint32_t seed)
{
    const auto id = uint32_t(charts_.size());
    Chart chart;
    chart.triangles = {seed};
    chartOf_[seed] = id;
    Vec3 sum = area_[seed] * normal_[seed];
    for (size_t i = 0; i < chart.triangles.size(); ++i) // breadth first: round charts
        for (uint32_t next : neighbours_[chart.triangles[i]])
            if (next != kNone && chartOf_[next] == kNone &&
                glm::dot(normal_[next], unit(sum)) >= kGrowCosine) {
                chartOf_[next] = id;
                sum += area_[next] * normal_[next];
                chart.triangles.push_back(next);
            }
    chart.axis = unit(sum);
    if (glm::dot(normal_[seed], chart.axis) < kLeastCosine)
        chart.axis = normal_[seed];
    std::erase_if(chart.triangles, [&](uint32_t t) {
        const bool out = glm::dot(normal_[t], chart.axis) < kLeastCosine;
        if (out)
            chartOf_[t] = kNone;
        return out;
    });
    charts_.push_back(std::move(chart));
}

// Joins the chart to the neighbour with the longest common border that the cone allows.
bool ChartCutter::tryMerge(uint32_t small)
{
    Chart& chart = charts_[small];
    std::map<uint32_t, double> borders; // metres, by chart
    for (uint32_t t : chart.triangles)
        for (size_t c = 0; c < 3; ++c) {
            const uint32_t next = neighbours_[t][c];
            if (next != kNone && chartOf_[next] != small)
                borders[chartOf_[next]] += glm::distance(corner(t, c), corner(t, (c + 1) % 3));
        }
    std::vector<std::pair<double, uint32_t>> candidates;
    for (const auto& [other, length] : borders)
        candidates.emplace_back(-length, other);
    std::sort(candidates.begin(), candidates.end());
    for (const auto& [length, other] : candidates) {
        Chart& target = charts_[other];
        const Vec3 axis = unit(weightedNormal(chart.triangles) + weightedNormal(target.triangles));
        if (!within(chart.triangles, axis) || !within(target.triangles, axis))
            continue;
        for (uint32_t t : chart.triangles)
            chartOf_[t] = other;
        target.triangles.insert(target.triangles.end(), chart.triangles.begin(), chart.triangles.end());
        target.axis = axis;
        chart.triangles.clear();
        return true;
    }
    return false;
}

bool ChartCutter::mergeSmall()
{
    std::vector<std::pair<double, uint32_t>> order; // area, chart
    for (uint32_t i = 0; i < charts_.size(); ++i)
        if (!charts_[i].triangles.empty())
            order.emplace_back(glm::length(weightedNormal(charts_[i].triangles)), i);
    std::sort(order.begin(), order.end());
    bool merged = false;
    for (const auto& [area, id] : order)
        merged = tryMerge(id) || merged;
    return merged;
}

// Each part in order of distance from its first triangle.
std::vector<std::vector<uint32_t>> ChartCutter::connectedParts(std::span<const uint32_t> triangles)
{
    constexpr uint32_t kWaiting = kNone - 1;
    for (uint32_t t : triangles)
        chartOf_[t] = kWaiting;
    std::vector<std::vector<uint32_t>> parts;
    for (uint32_t start : triangles) {
        if (chartOf_[start] != kWaiting)
            continue;
        std::vector<uint32_t> part = {start};
        chartOf_[start] = kNone;
        for (size_t i = 0; i < part.size(); ++i)
            for (uint32_t next : neighbours_[part[i]])
                if (next != kNone && chartOf_[next] == kWaiting) {
                    chartOf_[next] = kNone;
                    part.push_back(next);
                }
        parts.push_back(std::move(part));
    }
    return parts;
}

void ChartCutter::splitFolds()
{
    std::vector<Chart> waiting = std::move(charts_), done;
    std::reverse(waiting.begin(), waiting.end());
    while (!waiting.empty()) {
        Chart chart = std::move(waiting.back());
        waiting.pop_back();
        if (chart.triangles.empty())
            continue;
        if (chart.triangles.size() == 1 || !folds(mesh_, chart)) {
            done.push_back(std::move(chart));
            continue;
        }
        const auto parts = connectedParts(chart.triangles);
        const std::vector<uint32_t>& whole = parts.front();
        const size_t half = parts.size() > 1 ? whole.size() : whole.size() / 2;
        waiting.push_back({{whole.begin(), whole.begin() + std::ptrdiff_t(half)}, chart.axis});
        for (auto& rest : connectedParts(std::span(whole).subspan(half)))
            waiting.push_back({std::move(rest), chart.axis});
        for (size_t i = 1; i < parts.size(); ++i)
            waiting.push_back({parts[i], chart.axis});
    }
    charts_ = std::move(done);
}

glm::dvec2 turned(glm::dvec2 p, glm::dvec2 direction)
{
    return {p.x * direction.x + p.y * direction.y, p.y * direction.x - p.x * direction.y};
}

} // namespace

std::vector<Chart> cutCharts(const Mesh& mesh)
{
    return ChartCutter(mesh).cut();
}

std::vector<FlatTriangle> flatten(const Mesh& mesh, const Chart& chart)
{
    std::vector<FlatTriangle> flat = project(mesh, chart);
    // Candidates: the longest edge, and turned from it by steps of 90 / 32 degrees; among them is 45 degrees,
    // where the longest edge is a square's diagonal.
    glm::dvec2 longest(1.0, 0.0);
    double length = 0.0;
    for (const FlatTriangle& t : flat)
        for (size_t c = 0; c < 3; ++c)
            if (const glm::dvec2 edge = t[(c + 1) % 3] - t[c]; glm::length(edge) > length * (1.0 + 1e-9)) {
                length = glm::length(edge);
                longest = edge / length;
            }
    constexpr int kTurns = 32;
    double least = std::numeric_limits<double>::max();
    glm::dvec2 best = longest;
    for (int i = 0; i < kTurns; ++i) {
        const double angle = 0.5 * std::numbers::pi * i / kTurns;
        const glm::dvec2 direction = turned(longest, {std::cos(angle), std::sin(angle)});
        glm::dvec2 lower(std::numeric_limits<double>::max()), upper(-lower);
        for (const FlatTriangle& t : flat)
            for (const glm::dvec2 p : t) {
                lower = glm::min(lower, turned(p, direction));
                upper = glm::max(upper, turned(p, direction));
            }
        if (const double area = (upper.x - lower.x) * (upper.y - lower.y); area < least * (1.0 - 1e-6)) {
            least = area;
            best = direction;
        }
    }
    for (FlatTriangle& t : flat)
        for (glm::dvec2& p : t)
            p = turned(p, best);
    return flat;
}

} // namespace lumel::scene
