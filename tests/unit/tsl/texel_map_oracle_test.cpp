// Texel maps against a plain way to make them: every centre against every triangle around it, level by level.
#include "../scene/shapes.h"
#include "charts/unwrap.h"
#include "tsl/texel_map.h"
#include <gtest/gtest.h>
#include <random>

namespace lumel::tsl {
namespace {

using shared::kTexelCoverageShift;
using shared::kTexelTriangleMask;

// Writes `value` to every lumel of the level whose centre lies in the triangle. Edge functions in
// double: lumel coordinates reach 8192 and products of differences need more than float's 24 bits.
void rasterise(const std::array<glm::dvec2, 3>& corners, uint32_t value, glm::uvec2 size, uint32_t* texels)
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
    const auto lower = glm::max(glm::floor(glm::min(glm::min(a, b), c) - 0.5), glm::dvec2(0.0));
    const auto upper = glm::min(glm::ceil(glm::max(glm::max(a, b), c)), glm::dvec2(size) - 1.0);
    for (int y = int(lower.y); y <= int(upper.y); ++y)
        for (int x = int(lower.x); x <= int(upper.x); ++x) {
            const glm::dvec2 p(x + 0.5, y + 0.5);
            if (edge(a, b, p) >= 0.0 && edge(b, c, p) >= 0.0 && edge(c, a, p) >= 0.0)
                texels[size_t(y) * size.x + x] = value;
        }
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
    for (uint32_t y = 0; y < size.y; ++y)
        for (uint32_t x = 0; x < size.x; ++x) {
            uint32_t sum = 0, best = 0;
            for (uint32_t j = 0; j < ratio.y; ++j)
                for (uint32_t i = 0; i < ratio.x; ++i) {
                    const uint32_t child = fine[size_t(y * ratio.y + j) * fineSize.x + x * ratio.x + i];
                    sum += child >> kTexelCoverageShift;
                    if (child >> kTexelCoverageShift > best >> kTexelCoverageShift)
                        best = child;
                }
            const uint32_t count = ratio.x * ratio.y, coverage = (sum + count - 1) / count;
            uint32_t& texel = coarse[size_t(y) * size.x + x];
            const uint32_t triangle = (texel & kTexelTriangleMask) && coverage ? texel : best;
            texel = coverage ? (triangle & kTexelTriangleMask) | coverage << kTexelCoverageShift : 0u;
        }
}

void dilate(uint32_t* texels, glm::uvec2 size)
{
    const std::vector<uint32_t> before(texels, texels + size_t(size.x) * size.y);
    constexpr int kNeighbours[8][2] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}, {-1, -1}, {1, -1}, {-1, 1}, {1, 1}};
    const auto at = [&](int x, int y) {
        const bool inside = x >= 0 && y >= 0 && x < int(size.x) && y < int(size.y);
        return inside ? before[size_t(y) * size.x + size_t(x)] & kTexelTriangleMask : 0;
    };
    for (int y = 0; y < int(size.y); ++y)
        for (int x = 0; x < int(size.x); ++x)
            for (size_t i = 0; i < 8 && !before[size_t(y) * size.x + size_t(x)]; ++i)
                if (const uint32_t found = at(x + kNeighbours[i][0], y + kNeighbours[i][1])) {
                    texels[size_t(y) * size.x + size_t(x)] = found;
                    break;
                }
}

UninitialisedArray<uint32_t> plainTexels(const scene::Mesh& mesh, const TexelMap& like)
{
    UninitialisedArray<uint32_t> all(like.texels.size(), 0);
    for (uint32_t level = 0; level < like.levels; ++level) {
        uint32_t* texels = all.data() + like.offsets[level];
        const glm::uvec2 size = like.levelSize(level);
        for (size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
            std::array<glm::dvec2, 3> corners;
            for (size_t k = 0; k < 3; ++k)
                corners[k] = glm::dvec2(mesh.vertices[mesh.indices[i + k]].uv) * glm::dvec2(size);
            rasterise(corners, uint32_t(i / 3 + 1), size, texels);
        }
        if (level > 0) {
            coverFromChildren(all.data() + like.offsets[level - 1], like.levelSize(level - 1), texels, size);
            continue;
        }
        placeStrays(mesh, size, texels);
        for (size_t i = 0; i < size_t(size.x) * size.y; ++i)
            if (texels[i])
                texels[i] |= 255u << kTexelCoverageShift;
    }
    for (uint32_t level = 0; level < like.levels; ++level)
        for (int ring = 0; ring < kGutter; ++ring)
            dilate(all.data() + like.offsets[level], like.levelSize(level));
    return all;
}

void expectPlain(const scene::Mesh& mesh, glm::uvec2 size)
{
    const TexelMap map = makeTexelMap(mesh, size);
    EXPECT_EQ(map.texels, plainTexels(mesh, map)) << size.x << " x " << size.y;
}

// Triangles anywhere, overlapping; a part of their coordinates lie on lumel centres and borders, so that
// edges pass exactly through them.
scene::Mesh randomTriangles(std::mt19937& random, int count, float extent)
{
    std::uniform_real_distribution<float> unit(0.0f, 1.0f);
    scene::Mesh mesh;
    for (int i = 0; i < count; ++i) {
        const glm::vec2 centre(unit(random), unit(random));
        const bool snap = unit(random) < 0.5f;
        for (int k = 0; k < 3; ++k) {
            glm::vec2 uv = centre + extent * (glm::vec2(unit(random), unit(random)) - 0.5f);
            if (snap)
                uv = glm::round(uv * 256.0f) / 256.0f;
            shared::Vertex vertex{};
            vertex.uv = glm::clamp(uv, 0.0f, 1.0f);
            mesh.indices.push_back(uint32_t(mesh.vertices.size()));
            mesh.vertices.push_back(vertex);
        }
    }
    return mesh;
}

TEST(TexelMapOracle, RandomTriangles)
{
    std::mt19937 random(7);
    for (const float extent : {0.004f, 0.05f, 0.5f, 2.0f})
        for (const glm::uvec2 size : {glm::uvec2(128, 128), glm::uvec2(256, 64), glm::uvec2(32, 512)})
            expectPlain(randomTriangles(random, extent < 0.1f ? 400 : 40, extent), size);
}

TEST(TexelMapOracle, Slivers)
{
    std::mt19937 random(8);
    std::uniform_real_distribution<float> unit(0.0f, 1.0f);
    scene::Mesh mesh = randomTriangles(random, 300, 0.7f);
    for (size_t i = 0; i + 2 < mesh.vertices.size(); i += 3) // the third corner is about on the first side
        mesh.vertices[i + 2].uv = glm::mix(mesh.vertices[i].uv, mesh.vertices[i + 1].uv, unit(random));
    expectPlain(mesh, {256, 256});
}

TEST(TexelMapOracle, AnUnwrappedMesh)
{
    scene::Mesh mesh = scene::gridShape(48, 24, [](float s, float t) { // a torus with waves
        const float a = 6.2831853f * s, b = 6.2831853f * t, radius = 0.3f + 0.05f * std::sin(5.0f * a);
        const float across = 1.0f + radius * std::cos(b);
        return glm::vec3(across * std::cos(a), across * std::sin(a), radius * std::sin(b));
    });
    scene::apply(scene::unwrap(mesh), mesh);
    for (const uint32_t size : {64u, 512u})
        expectPlain(mesh, {size, size});
}

} // namespace
} // namespace lumel::tsl
