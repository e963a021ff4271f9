#include "unwrap.h"
#include "core/error.h"
#include "flatten.h"
#include <fmt/format.h>
#include <unordered_map>
// One header, public domain; Debian's package has no library.
#define STB_RECT_PACK_IMPLEMENTATION
#define STBRP_STATIC
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_rect_pack.h>
#pragma GCC diagnostic pop

namespace lumel::scene {
namespace {

// Cells of the texture that boxes are packed in. Gaps: 32 cells are 8 lumels of the smallest lumel grid and
// keep charts apart for filters down to a fourth of it; a mesh of so many charts that gaps would take
// most of the texture gets narrower ones, and a finer grid (lumelGrid()).
constexpr int kCells = 4096;
constexpr int kWidestGap = 32, kNarrowestGap = 4;
constexpr double kGoodShare = 0.4; // of the texture; below, narrower gaps are tried

constexpr size_t kMostTriangles = size_t(1) << 21;
constexpr size_t kMostCharts = size_t(1) << 16;

constexpr uint32_t kUnplaced = ~0u; // a corner that has no vertex yet

// A chart on its plane at even density: as large as its surface, its corner at (0, 0).
struct FlatChart {
    std::vector<FlatTriangle> triangles;
    glm::dvec2 size{0.0};
};

double areaOf(const Mesh& mesh, uint32_t t)
{
    const auto corner = [&](size_t c) { return glm::dvec3(mesh.vertices[mesh.indices[3 * t + c]].position); };
    return 0.5 * glm::length(glm::cross(corner(1) - corner(0), corner(2) - corner(0)));
}

double areaOf(const FlatTriangle& t)
{
    return 0.5 * std::abs((t[1].x - t[0].x) * (t[2].y - t[0].y) - (t[1].y - t[0].y) * (t[2].x - t[0].x));
}

FlatChart flattenEvenly(const Mesh& mesh, const Chart& chart)
{
    FlatChart result{.triangles = flatten(mesh, chart)};
    double surface = 0.0, plane = 0.0;
    glm::dvec2 lower(std::numeric_limits<double>::max()), upper(-lower);
    for (size_t i = 0; i < chart.triangles.size(); ++i) {
        surface += areaOf(mesh, chart.triangles[i]);
        plane += areaOf(result.triangles[i]);
        for (const glm::dvec2 p : result.triangles[i]) {
            lower = glm::min(lower, p);
            upper = glm::max(upper, p);
        }
    }
    const double scale = plane > 0.0 ? std::sqrt(surface / plane) : 1.0;
    for (FlatTriangle& t : result.triangles)
        for (glm::dvec2& p : t)
            p = (p - lower) * scale;
    result.size = (upper - lower) * scale;
    return result;
}

// Boxes of all charts at `scale` cells a metre. False when they do not fit.
bool pack(const std::vector<FlatChart>& charts, double scale, int gap, std::vector<stbrp_rect>& boxes)
{
    boxes.resize(charts.size());
    for (size_t i = 0; i < charts.size(); ++i) {
        const glm::dvec2 size = glm::ceil(charts[i].size * scale);
        if (size.x > kCells || size.y > kCells)
            return false;
        boxes[i] = {.id = int(i),
                    .w = std::max(int(size.x), 1) + gap,
                    .h = std::max(int(size.y), 1) + gap,
                    .x = 0,
                    .y = 0,
                    .was_packed = 0};
    }
    stbrp_context context;
    std::vector<stbrp_node> nodes(kCells);
    stbrp_init_target(&context, kCells, kCells, nodes.data(), int(nodes.size()));
    return stbrp_pack_rects(&context, boxes.data(), int(boxes.size())) != 0;
}

struct Packing {
    std::vector<stbrp_rect> boxes;
    double scale = 0.0; // cells a metre; 0: nothing fits
    int gap = 0;
};

// The largest scale that fits, within half a percent.
Packing packTightly(const std::vector<FlatChart>& charts, int gap)
{
    double boxArea = 0.0, longest = 0.0;
    for (const FlatChart& chart : charts) {
        boxArea += chart.size.x * chart.size.y;
        longest = std::max({longest, chart.size.x, chart.size.y});
    }
    // No larger than the texture's area and side allow.
    double upper = std::min(kCells / std::sqrt(std::max(boxArea, 1e-300)), kCells / longest);
    double lower = 0.0;
    Packing best{.boxes = {}, .scale = 0.0, .gap = gap};
    std::vector<stbrp_rect> boxes;
    for (int i = 0; i < 14 && upper - lower > 0.005 * upper; ++i) {
        const double scale = 0.5 * (lower + upper);
        if (pack(charts, scale, gap, boxes)) {
            lower = scale;
            best.boxes = boxes;
            best.scale = scale;
        } else {
            upper = scale;
        }
    }
    return best;
}

Packing packCharts(const std::vector<FlatChart>& charts)
{
    double surface = 0.0;
    for (const FlatChart& chart : charts)
        for (const FlatTriangle& t : chart.triangles)
            surface += areaOf(t);
    Packing best;
    for (int gap = kWidestGap; gap >= kNarrowestGap; gap /= 2) {
        Packing packing = packTightly(charts, gap);
        if (packing.scale > best.scale)
            best = std::move(packing);
        if (surface * best.scale * best.scale >= kGoodShare * kCells * kCells)
            break;
    }
    return best;
}

// New vertices: one for each old vertex and chart that it belongs to.
void addChart(const Mesh& mesh, const Chart& chart, const FlatChart& flat, const stbrp_rect& box,
              const Packing& packing, Unwrapping& out)
{
    std::unordered_map<uint32_t, uint32_t> added;
    const glm::dvec2 origin = glm::dvec2(box.x, box.y) + 0.5 * packing.gap;
    for (size_t i = 0; i < chart.triangles.size(); ++i)
        for (size_t c = 0; c < 3; ++c) {
            const size_t slot = 3 * chart.triangles[i] + c;
            const auto [entry, isNew] = added.try_emplace(mesh.indices[slot], uint32_t(out.sources.size()));
            if (isNew) {
                out.sources.push_back(mesh.indices[slot]);
                out.uvs.push_back(
                    glm::vec2((origin + flat.triangles[i][c] * packing.scale) / double(kCells)));
            }
            out.indices[slot] = entry->second;
        }
}

// Triangles without area shrink to a point, that of a corner which belongs to a chart: should a sample hit
// one, it shows its neighbour.
void placeThin(const Mesh& mesh, Unwrapping& out)
{
    const std::vector<uint32_t> welded = weldPositions(mesh);
    std::vector<glm::vec2> uvAt(mesh.vertices.size(), glm::vec2(-1.0f));
    for (size_t i = 0; i < out.sources.size(); ++i)
        uvAt[welded[out.sources[i]]] = out.uvs[i];
    for (size_t t = 0; t < out.indices.size(); t += 3) {
        if (out.indices[t] != kUnplaced)
            continue;
        glm::vec2 uv(0.0f);
        for (size_t c = 0; c < 3; ++c)
            if (const glm::vec2 found = uvAt[welded[mesh.indices[t + c]]]; found.x >= 0.0f)
                uv = found;
        for (size_t c = 0; c < 3; ++c) {
            out.indices[t + c] = uint32_t(out.sources.size());
            out.sources.push_back(mesh.indices[t + c]);
            out.uvs.push_back(uv);
        }
    }
}

} // namespace

Unwrapping unwrap(const Mesh& mesh)
{
    if (mesh.indices.size() / 3 > kMostTriangles)
        throw Error(fmt::format("more than {} triangles to unwrap", kMostTriangles));
    const std::vector<Chart> charts = cutCharts(mesh);
    if (charts.empty())
        throw Error("no area to unwrap");
    if (charts.size() > kMostCharts)
        throw Error(fmt::format("more than {} charts to unwrap", kMostCharts));
    std::vector<FlatChart> flat;
    flat.reserve(charts.size());
    for (const Chart& chart : charts)
        flat.push_back(flattenEvenly(mesh, chart));
    const Packing packing = packCharts(flat);
    if (packing.scale == 0.0)
        throw Error(fmt::format("{} charts do not fit", charts.size()));

    Unwrapping out;
    out.indices.assign(mesh.indices.size(), kUnplaced);
    out.charts = uint32_t(charts.size());
    out.gap = float(packing.gap) / float(kCells);
    for (const stbrp_rect& box : packing.boxes)
        addChart(mesh, charts[size_t(box.id)], flat[size_t(box.id)], box, packing, out);
    placeThin(mesh, out);
    return out;
}

void apply(const Unwrapping& unwrapping, Mesh& mesh)
{
    std::vector<Vertex> vertices;
    std::vector<glm::vec4> colours;
    vertices.reserve(unwrapping.sources.size());
    for (size_t i = 0; i < unwrapping.sources.size(); ++i) {
        vertices.push_back(mesh.vertices[unwrapping.sources[i]]);
        vertices.back().uv = unwrapping.uvs[i];
        if (!mesh.colours.empty())
            colours.push_back(mesh.colours[unwrapping.sources[i]]);
    }
    mesh.vertices = std::move(vertices);
    mesh.colours = std::move(colours);
    mesh.indices = unwrapping.indices;
    mesh.deformation = gathered(mesh.deformation, unwrapping.sources);
    mesh.unwrapped = measureUnwrap(mesh);
    mesh.unwrapped->charts = unwrapping.charts;
    mesh.unwrapped->gap = unwrapping.gap;
}

UnwrapReport measureUnwrap(const Mesh& mesh)
{
    struct Piece {
        double area, density, stretch;
    };
    std::vector<Piece> pieces;
    double surface = 0.0, covered = 0.0;
    for (size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        const Vertex &a = mesh.vertices[mesh.indices[i]], &b = mesh.vertices[mesh.indices[i + 1]],
                     &c = mesh.vertices[mesh.indices[i + 2]];
        // The triangle in its own plane, its first edge along x.
        const glm::dvec3 p = glm::dvec3(b.position) - glm::dvec3(a.position),
                         q = glm::dvec3(c.position) - glm::dvec3(a.position);
        const double along = glm::length(p), area = 0.5 * glm::length(glm::cross(p, q));
        const glm::dvec2 u = glm::dvec2(b.uv) - glm::dvec2(a.uv), v = glm::dvec2(c.uv) - glm::dvec2(a.uv);
        const double uvArea = 0.5 * std::abs(u.x * v.y - u.y * v.x);
        if (area <= 0.0 || uvArea <= 0.0)
            continue;
        const glm::dvec2 dx = u / along, dy = (v - dx * (glm::dot(p, q) / along)) * (along / (2.0 * area));
        // Singular values of (dx, dy): their squares' sum and their product.
        const double sum = glm::dot(dx, dx) + glm::dot(dy, dy), product = std::abs(dx.x * dy.y - dx.y * dy.x);
        const double spread = std::sqrt(std::max(sum * sum - 4.0 * product * product, 0.0));
        pieces.push_back({area, std::sqrt(uvArea / area), (sum + spread) / (2.0 * product)});
        surface += area;
        covered += uvArea;
    }
    UnwrapReport report;
    if (pieces.empty())
        return report;
    report.coveredShare = float(covered);
    const double mean = std::sqrt(covered / surface);
    report.leastDensity = std::numeric_limits<float>::max();
    report.worstStretch = 1.0f;
    double stretch = 0.0;
    for (const Piece& piece : pieces) {
        stretch += piece.stretch * piece.area / surface;
        // Slivers say more about rounding than about the mapping.
        if (piece.area < 1e-6 * surface)
            continue;
        report.worstStretch = std::max(report.worstStretch, float(piece.stretch));
        report.leastDensity = std::min(report.leastDensity, float(piece.density / mean));
        report.greatestDensity = std::max(report.greatestDensity, float(piece.density / mean));
    }
    report.meanStretch = float(stretch);
    return report;
}

} // namespace lumel::scene
