// A knot cut into 399 small charts, packed in a random order and orientation: shows mistakes at
// the borders of charts.
#include "gltf_writer.h"
#include "noise.h"
#include "scenes.h"
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <tbb/parallel_invoke.h>

namespace lumel::assets {
namespace {

constexpr float kTau = 2.0f * float(std::numbers::pi);
constexpr float kScale = 0.1f; // metres per unit: the knot is 0.6 m across
constexpr float kTube = 0.25f; // radius of the tube, units

// One chart per patch: 57 along the knot and 7 around it make patches that are nearly square.
constexpr int kAlong = 57, kAround = 7, kCharts = kAlong * kAround;
constexpr int kMap = 1024;           // texels
constexpr int kCells = 20;           // per row of the map: enough for 400 charts
constexpr int kCell = kMap / kCells; // texels, deliberately odd: coarse texels straddle cells
constexpr int kGutter = 2;           // texels around each chart
constexpr int kDivisions = 5;        // quads along a chart's side

// Trefoil: the (2, 3) torus knot, on a torus of radii 1 and 0.45. `turn` in [0, 1).
glm::vec3 knot(float turn)
{
    const float a = kTau * turn, r = 1.0f + 0.45f * std::cos(3.0f * a);
    return {r * std::cos(2.0f * a), 0.45f * std::sin(3.0f * a), r * std::sin(2.0f * a)};
}

// `turn` at equal distances along the knot, so that patches have equal lengths.
float turnAt(float along)
{
    constexpr int kSteps = 4096;
    static const std::vector<float> lengths = [] {
        std::vector<float> sums(kSteps + 1, 0.0f);
        for (int i = 0; i < kSteps; ++i)
            sums[size_t(i) + 1] =
                sums[size_t(i)] + glm::distance(knot(float(i) / kSteps), knot(float(i + 1) / kSteps));
        return sums;
    }();
    const float length = (along - std::floor(along)) * lengths.back();
    const size_t next = std::max<size_t>(
        1, size_t(std::lower_bound(lengths.begin(), lengths.end(), length) - lengths.begin()));
    const float step = (length - lengths[next - 1]) / (lengths[next] - lengths[next - 1]);
    return (float(next - 1) + step) / kSteps;
}

struct Point {
    glm::vec3 position, normal; // units
};

// The tube's surface; `p` counts patches along the knot and around the tube. The Frenet frame,
// which is defined everywhere on a trefoil: its curvature never vanishes.
Point onTube(glm::vec2 p)
{
    const float turn = turnAt(p.x / kAlong);
    constexpr float kStep = 2e-3f;
    const glm::vec3 before = knot(turn - kStep), here = knot(turn), after = knot(turn + kStep);
    const glm::vec3 tangent = glm::normalize(after - before);
    const glm::vec3 curvature = after - 2.0f * here + before;
    const glm::vec3 inwards = glm::normalize(curvature - tangent * glm::dot(tangent, curvature));
    const float angle = kTau * p.y / kAround;
    const glm::vec3 normal = std::cos(angle) * inwards + std::sin(angle) * glm::cross(tangent, inwards);
    return {here + kTube * normal, normal};
}

// Which patch lies in each cell of the map, and by how many quarter turns it is turned there.
struct Packing {
    std::array<int, kCharts> patchOfCell, cellOfPatch;
    Packing()
    {
        std::iota(patchOfCell.begin(), patchOfCell.end(), 0);
        for (int i = kCharts - 1; i > 0; --i) // Fisher and Yates
            std::swap(patchOfCell[size_t(i)], patchOfCell[hash(uint32_t(i) + 901u) % uint32_t(i + 1)]);
        for (int i = 0; i < kCharts; ++i)
            cellOfPatch[size_t(patchOfCell[size_t(i)])] = i;
    }
};

const Packing& packing()
{
    static const Packing packing;
    return packing;
}

// Turns the unit square about its centre, clockwise in the map, by quarter turns.
glm::vec2 turned(glm::vec2 t, int quarters)
{
    for (int i = 0; i < quarters; ++i)
        t = {1.0f - t.y, t.x};
    return t;
}

int quartersOf(int patch)
{
    return int(hash(uint32_t(patch) + 977u) % 4u);
}

// The surface under a texel; in gutters its continuation past the chart.
Point underTexel(glm::vec2 texel)
{
    const glm::ivec2 cell = glm::min(glm::ivec2(texel) / kCell, glm::ivec2(kCells - 1));
    const int patch = packing().patchOfCell[size_t(std::min(cell.y * kCells + cell.x, kCharts - 1))];
    const glm::vec2 inCell = (texel - glm::vec2(cell * kCell) - float(kGutter)) / float(kCell - 2 * kGutter);
    const glm::vec2 t = turned(inCell, (4 - quartersOf(patch)) % 4);
    return onTube(glm::vec2(patch % kAlong, patch / kAlong) + t);
}

glm::vec2 uvOf(int patch, glm::vec2 t)
{
    const int cell = packing().cellOfPatch[size_t(patch)];
    const glm::vec2 inCell = float(kCell - 2 * kGutter) * turned(t, quartersOf(patch));
    return (glm::vec2(cell % kCells, cell / kCells) * float(kCell) + float(kGutter) + inCell) / float(kMap);
}

// The knot in metres, around the origin.
Shape knotShape()
{
    Shape shape;
    for (int patch = 0; patch < kCharts; ++patch) {
        const glm::vec2 corner(patch % kAlong, patch / kAlong);
        const uint32_t first = uint32_t(shape.vertices.size()), row = kDivisions + 1;
        for (uint32_t j = 0; j < row; ++j)
            for (uint32_t i = 0; i < row; ++i) {
                const glm::vec2 t = glm::vec2(i, j) / float(kDivisions);
                const Point here = onTube(corner + t);
                // Where the map's right and up lead on the surface, through the chart's quarter turns.
                constexpr float kStep = 0.02f;
                const int back = (4 - quartersOf(patch)) % 4;
                const glm::vec2 inMap = turned(t, quartersOf(patch));
                const auto at = [&](glm::vec2 offset) {
                    return onTube(corner + turned(inMap + offset, back)).position;
                };
                const glm::vec3 u = at({kStep, 0}) - at({-kStep, 0}), up = at({0, -kStep}) - at({0, kStep});
                shape.add(kScale * here.position, here.normal, tangentOf(u, up, here.normal), uvOf(patch, t));
            }
        for (uint32_t j = 0; j + 1 < row; ++j)
            for (uint32_t i = 0; i + 1 < row; ++i) {
                const uint32_t a = first + j * row + i;
                shape.quad(a, a + 1, a + row + 1, a + row);
            }
    }
    return shape;
}

// Hammered, as a function of the point in space, so that charts meet without a step.
float relief(glm::vec2 texel)
{
    const glm::vec3 p = underTexel(texel).position;
    float nearest = 1.0f;
    forNeighbours(9.0f * p, [&](const Scattered& point) {
        nearest = std::min(nearest, glm::dot(point.offset, point.offset));
    });
    return nearest + 0.10f * fbm3(26.0f * p, 2, 211);
}

// Bronze, polished where hands reach and dark in the dents.
glm::vec3 colour(glm::vec2 texel)
{
    const glm::vec3 p = underTexel(texel).position;
    const float worn = smooth(-0.25f, 0.3f, fbm3(2.2f * p, 3, 223));
    return glm::mix(glm::vec3(0.42f, 0.22f, 0.10f), glm::vec3(0.98f, 0.66f, 0.36f), worn);
}

} // namespace

void writeCharts(const std::filesystem::path& folder)
{
    GltfWriter gltf(folder, "charts");
    HeightMap height;
    Image colours;
    tbb::parallel_invoke(
        [&] {
            height = makeHeight(kMap, relief);
            setSlope(height, 0.30f);
        },
        [&] { colours = makeColour(kMap, colour); });
    const int bronze = gltf.addMaterial("bronze", {.baseColour = glm::vec3(1.0f),
                                                   .metallic = 1.0f,
                                                   .power = 70.0f,
                                                   .colourImage = gltf.addColour("bronze", colours),
                                                   .heightImage = gltf.addHeight("bronze", height)});
    const int stone = gltf.addMaterial("stone", {.baseColour = {0.030f, 0.032f, 0.036f}, .power = 12.0f});
    gltf.addObject("knot", gltf.addShape(knotShape()), bronze);
    gltf.addObject("floor", gltf.addShape(floorGrid(8.0f, 8.0f, 8)), stone,
                   {.position = {0.0f, -(0.45f + kTube) * kScale, 0.0f}});

    gltf.addCamera("default", {0.0f, 0.36f, 0.42f}, {0.0f, -0.01f, 0.01f}, 36.0f, 0.02f);
    gltf.addCamera("near", {0.10f, 0.15f, 0.24f}, {0.07f, 0.0f, 0.07f}, 34.0f, 0.01f);
    gltf.addCamera("far", {0.5f, 1.5f, 2.0f}, {0.0f, 0.0f, 0.0f}, 24.0f, 0.05f);
    gltf.addCamera("middle", {0.2f, 0.7f, 0.9f}, {0.0f, 0.0f, 0.0f}, 30.0f, 0.03f);
    gltf.addDirectional("key", {-0.7f, 1.0f, 0.35f}, {1.0f, 0.88f, 0.72f}, 3.6f);
    gltf.addDirectional("rim", {0.6f, 0.6f, -0.9f}, {0.55f, 0.75f, 1.0f}, 3.2f);
    gltf.addDirectional("fill", {0.5f, 0.7f, 1.0f}, {0.95f, 0.97f, 1.0f}, 1.7f);
    gltf.write();
}

} // namespace lumel::assets
