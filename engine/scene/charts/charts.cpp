// Charts grow from the largest triangles over neighbours whose normals stay near the chart's mean (Sander et
// al. 2001, "Texture Mapping Progressive Meshes", use the same cone), then small ones join neighbours where
// the cone allows it, then what folds over itself on its plane, or leaves much of its box empty, is
// halved until nothing does. Plane projection
// is the simplest mapping with a stretch that is known beforehand; conformal ones (Levy et al. 2002) give
// fewer charts, but a density that is not bounded.
#include "flatten.h"
#include <map>
#include <numeric>
#include <queue>

namespace lumel::scene {
namespace {

using Vec3 = glm::dvec3;

constexpr uint32_t kNone = ~0u;
constexpr double kGrowCosine = 0.82; // 35 degrees from the running mean: leaves a margin for the mean to move

Vec3 unit(Vec3 v)
{
    const double length = glm::length(v);
    return length > 0.0 ? v / length : Vec3(0.0);
}

class ChartCutter {
public:
    explicit ChartCutter(const Mesh& mesh)
        : mesh_(mesh), count_(mesh.indices.size() / 3), area_(count_), normal_(count_),
          neighbours_(count_, {kNone, kNone, kNone}), chartOf_(count_, kNone)
    {
        for (size_t t = 0; t < count_; ++t) {
            const Vec3 across = glm::cross(corner(t, 1) - corner(t, 0), corner(t, 2) - corner(t, 0));
            const double longest = std::max({glm::distance(corner(t, 0), corner(t, 1)),
                                             glm::distance(corner(t, 1), corner(t, 2)),
                                             glm::distance(corner(t, 2), corner(t, 0))});
            if (glm::length(across) <= kThinnest * longest * longest)
                continue;
            area_[t] = 0.5 * glm::length(across);
            normal_[t] = unit(across);
        }
        findNeighbours();
    }

    std::vector<Chart> cut()
    {
        growAll();
        for (int round = 0; round < kRegrowths; ++round)
            regrow();
        for (int pass = 0; pass < kMostMergePasses && mergeSmall(); ++pass)
            ;
        splitFolds();
        return std::move(charts_);
    }

private:
    static constexpr int kRegrowths = 3, kMostMergePasses = 8;

    Vec3 corner(size_t t, size_t c) const { return mesh_.vertices[mesh_.indices[3 * t + c]].position; }

    void findNeighbours();
    void growAll();
    void growFrom(uint32_t seed);
    void regrow();
    uint32_t middleOf(const Chart& chart) const;
    bool mergeSmall();
    bool tryMerge(uint32_t small);
    void splitFolds();
    bool isWasteful(const Chart& chart, double total) const;
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

// The triangle nearest to the chart's centre among those that face along its axis.
uint32_t ChartCutter::middleOf(const Chart& chart) const
{
    const auto centre = [&](uint32_t t) { return (corner(t, 0) + corner(t, 1) + corner(t, 2)) / 3.0; };
    Vec3 sum(0.0);
    double area = 0.0;
    for (uint32_t t : chart.triangles) {
        sum += area_[t] * centre(t);
        area += area_[t];
    }
    std::tuple<bool, double, uint32_t> best(true, std::numeric_limits<double>::max(), kNone);
    for (uint32_t t : chart.triangles)
        best = std::min(
            best, {glm::dot(normal_[t], chart.axis) < kGrowCosine, glm::distance(centre(t), sum / area), t});
    return std::get<2>(best);
}

// Grows the larger charts again, all at once from their middles along their axes, so that they share out what
// smaller ones had between them; then what is left (Cohen-Steiner et al. 2004, "Variational Shape
// Approximation").
void ChartCutter::regrow()
{
    const std::vector<Chart> before = std::move(charts_);
    double total = 0.0;
    for (const Chart& chart : before)
        total += glm::length(weightedNormal(chart.triangles));
    charts_.clear();
    std::fill(chartOf_.begin(), chartOf_.end(), kNone);
    using Step = std::tuple<double, uint32_t, uint32_t>; // 1 - cosine to the axis, triangle, chart
    std::priority_queue<Step, std::vector<Step>, std::greater<>> steps;
    for (const Chart& chart : before)
        if (glm::length(weightedNormal(chart.triangles)) >= 0.25 * total / double(before.size())) {
            steps.emplace(0.0, middleOf(chart), uint32_t(charts_.size()));
            charts_.push_back({{}, chart.axis});
        }
    while (!steps.empty()) {
        const auto [cost, t, id] = steps.top();
        steps.pop();
        if (chartOf_[t] != kNone)
            continue;
        chartOf_[t] = id;
        charts_[id].triangles.push_back(t);
        for (uint32_t next : neighbours_[t])
            if (next != kNone && chartOf_[next] == kNone &&
                glm::dot(normal_[next], charts_[id].axis) >= kLeastCosine)
                steps.emplace(1.0 - glm::dot(normal_[next], charts_[id].axis), next, id);
    }
    for (Chart& chart : charts_)
        if (const Vec3 mean = unit(weightedNormal(chart.triangles)); within(chart.triangles, mean))
            chart.axis = mean;
    growAll();
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

// Does a large chart leave most of its box empty? Arcs and rings do.
bool ChartCutter::isWasteful(const Chart& chart, double total) const
{
    constexpr double kLarge = 0.005, kFilled = 0.4; // of the mesh, of the box
    if (glm::length(weightedNormal(chart.triangles)) < kLarge * total)
        return false;
    glm::dvec2 lower(std::numeric_limits<double>::max()), upper(-lower);
    double area = 0.0;
    for (const FlatTriangle& t : flatten(mesh_, chart)) {
        for (const glm::dvec2 p : t) {
            lower = glm::min(lower, p);
            upper = glm::max(upper, p);
        }
        area += 0.5 * std::abs((t[1].x - t[0].x) * (t[2].y - t[0].y) - (t[1].y - t[0].y) * (t[2].x - t[0].x));
    }
    return area < kFilled * (upper.x - lower.x) * (upper.y - lower.y);
}

void ChartCutter::splitFolds()
{
    const double total = std::accumulate(area_.begin(), area_.end(), 0.0);
    std::vector<Chart> waiting = std::move(charts_), done;
    std::reverse(waiting.begin(), waiting.end());
    while (!waiting.empty()) {
        Chart chart = std::move(waiting.back());
        waiting.pop_back();
        if (chart.triangles.empty())
            continue;
        if (chart.triangles.size() == 1 || (!folds(mesh_, chart) && !isWasteful(chart, total))) {
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

} // namespace

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

std::vector<Chart> cutCharts(const Mesh& mesh)
{
    return ChartCutter(mesh).cut();
}

} // namespace lumel::scene
