#include "core/error.h"
#include "tsl/texel_map.h"
#include <gtest/gtest.h>

using namespace lumel;
using namespace lumel::tsl;

namespace {

// Axis-aligned chart of two triangles covering [x0, x1] x [y0, y1] of the texture.
void addChart(scene::Mesh& mesh, float x0, float y0, float x1, float y1)
{
    const auto base = uint32_t(mesh.vertices.size());
    for (const glm::vec2 uv : {glm::vec2(x0, y0), {x1, y0}, {x1, y1}, {x0, y1}})
        mesh.vertices.push_back({.position = {uv.x, -uv.y, 0.0f},
                                 .normal = {0, 0, 1},
                                 .tangent = {1, 0, 0, 1},
                                 .uv = uv,
                                 .materialUv = uv,
                                 .emissionUv = uv});
    for (const uint32_t i : {0u, 3u, 2u, 0u, 2u, 1u})
        mesh.indices.push_back(base + i);
}

uint32_t triangleOf(uint32_t texel)
{
    return texel & shared::kTexelTriangleMask;
}

uint32_t coverageOf(uint32_t texel)
{
    return texel >> shared::kTexelCoverageShift;
}

} // namespace

TEST(TexelMap, FullSquareIsCoveredOnAllLevels)
{
    scene::Mesh mesh;
    addChart(mesh, 0, 0, 1, 1);
    const TexelMap map = makeTexelMap(mesh, {16, 8});
    ASSERT_EQ(map.levels, 5u);
    for (uint32_t level = 0; level < map.levels; ++level)
        for (uint32_t y = 0; y < map.levelSize(level).y; ++y)
            for (uint32_t x = 0; x < map.levelSize(level).x; ++x) {
                EXPECT_EQ(coverageOf(map.at(level, x, y)), 255u);
                EXPECT_GE(triangleOf(map.at(level, x, y)), 1u);
                EXPECT_LE(triangleOf(map.at(level, x, y)), 2u);
            }
}

TEST(TexelMap, EachLumelHoldsTheTriangleUnderItsCentre)
{
    scene::Mesh mesh;
    addChart(mesh, 0, 0, 1, 1); // triangles (0,0)(0,1)(1,1) and (0,0)(1,1)(1,0): split along u = v
    const TexelMap map = makeTexelMap(mesh, {32, 32});
    for (uint32_t y = 0; y < 32; ++y)
        for (uint32_t x = 0; x < 32; ++x) {
            if (x == y)
                continue; // centre on the shared edge: either
            EXPECT_EQ(triangleOf(map.at(0, x, y)), x < y ? 1u : 2u) << x << ", " << y;
        }
}

TEST(TexelMap, CoverageIsTheShareOfCoveredLevelZeroLumels)
{
    scene::Mesh mesh;
    addChart(mesh, 0, 0, 0.25f, 1); // 4 of 16 columns
    const TexelMap map = makeTexelMap(mesh, {16, 16});
    const uint32_t top = map.levels - 1;
    EXPECT_NEAR(coverageOf(map.at(top, 0, 0)), 255.0 / 4.0, 2.0);
    EXPECT_EQ(coverageOf(map.at(2, 0, 0)), 255u); // 4 x 4 lumels, the first column full
    EXPECT_EQ(coverageOf(map.at(2, 1, 0)), 0u);
}

TEST(TexelMap, CoverageNeverVanishesDownTheChain)
{
    scene::Mesh mesh;
    addChart(mesh, 0.4f, 0.4f, 0.405f, 0.405f); // about one lumel of 256
    const TexelMap map = makeTexelMap(mesh, {256, 256});
    for (uint32_t level = 0; level < map.levels; ++level) {
        bool covered = false;
        for (uint32_t y = 0; y < map.levelSize(level).y; ++y)
            for (uint32_t x = 0; x < map.levelSize(level).x; ++x)
                covered |= coverageOf(map.at(level, x, y)) > 0 && triangleOf(map.at(level, x, y)) > 0;
        EXPECT_TRUE(covered) << "level " << level;
    }
}

TEST(TexelMap, GuttersExtendTheNearestChartByTheFilterReach)
{
    scene::Mesh mesh;
    addChart(mesh, 0, 0, 0.25f, 1);
    const TexelMap map = makeTexelMap(mesh, {64, 64});
    for (uint32_t x = 16; x < 64; ++x) {
        const uint32_t texel = map.at(0, x, 30);
        EXPECT_EQ(coverageOf(texel), 0u);
        EXPECT_EQ(triangleOf(texel) != 0, x < 16 + uint32_t(kGutter)) << x;
    }
}

TEST(TexelMap, DegenerateTrianglesCoverNothing)
{
    scene::Mesh mesh;
    addChart(mesh, 0.5f, 0, 0.5f, 1);
    for (const uint32_t texel : makeTexelMap(mesh, {32, 32}).texels)
        EXPECT_EQ(texel, 0u);
}

TEST(LumelGrid, IsAPowerOfTwoAndTwiceAsFineAsTheMaterial)
{
    const glm::ivec2 none(1); // no emission that varies
    EXPECT_EQ(lumelGrid({1, 1}, none), glm::uvec2(kMinGrid));
    EXPECT_EQ(lumelGrid({1000, 600}, none), glm::uvec2(2048, 2048));
    EXPECT_EQ(lumelGrid({2048, 1024}, none), glm::uvec2(4096, 2048));
    EXPECT_EQ(lumelGrid({16384, 16384}, none), glm::uvec2(kMaxGrid));
    EXPECT_EQ(lumelGrid({1, 1}, {4096, 2048}), glm::uvec2(4096, 2048)) << "emission shows as finely as it is";
    EXPECT_EQ(lumelGrid({1024, 1024}, {2048, 4096}), glm::uvec2(2048, 4096));
}
