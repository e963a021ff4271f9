#include "tsl/packed_texels.h"
#include <bit>
#include <gtest/gtest.h>
#include <random>

using namespace lumel;
using namespace lumel::tsl;

namespace {

// Random small triangles, so that there are gutters of many shapes.
TexelMap scatteredMap(glm::uvec2 size)
{
    scene::Mesh mesh;
    std::mt19937 random(7);
    std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
    for (int i = 0; i < 12; ++i) {
        const glm::vec2 corner(0.9f * uniform(random), 0.9f * uniform(random));
        for (const glm::vec2 step : {glm::vec2(0.0f), {0.1f, 0.02f}, {0.03f, 0.09f}}) {
            mesh.indices.push_back(uint32_t(mesh.vertices.size()));
            mesh.vertices.push_back({.position = {},
                                     .normal = {0, 0, 1},
                                     .tangent = {1, 0, 0, 1},
                                     .uv = corner + step,
                                     .materialUv = corner + step,
                                     .emissionUv = corner + step});
        }
    }
    return makeTexelMap(mesh, size);
}

TEST(PackedTexels, TrianglesAndCoverageAreTheMaps)
{
    const TexelMap map = scatteredMap({128, 64});
    const PackedTexels packed = pack(map);
    for (uint32_t level = 0; level < map.levels; ++level)
        for (uint32_t i = 0; i < map.levelSize(level).x * map.levelSize(level).y; ++i) {
            const uint32_t raw = map.texels[map.offsets[level] + i],
                           word = packed.words[packed.offsets[level] + i];
            ASSERT_EQ(word & shared::kTexelTriangleMask, raw & shared::kTexelTriangleMask);
            const uint32_t coverage = raw >> shared::kTexelCoverageShift;
            ASSERT_NEAR(float(shared::texelCoverage(word)) / 127.0f, float(coverage) / 255.0f, 0.01f);
            ASSERT_EQ(shared::texelCoverage(word) > 0, coverage > 0);
        }
}

// Against a search of all lumels around.
TEST(PackedTexels, GuttersNameTheNearestCoveredLumel)
{
    const TexelMap map = scatteredMap({128, 64});
    const PackedTexels packed = pack(map);
    int gutters = 0;
    for (uint32_t level = 0; level < map.levels; ++level) {
        const glm::ivec2 size(map.levelSize(level));
        const auto wordAt = [&](glm::ivec2 p) {
            return packed.words[packed.offsets[level] + uint32_t(p.y * size.x + p.x)];
        };
        for (int y = 0; y < size.y; ++y)
            for (int x = 0; x < size.x; ++x) {
                const uint32_t word = wordAt({x, y});
                if (!(word & shared::kTexelGutter))
                    continue;
                ++gutters;
                const glm::ivec2 step = shared::gutterSource(word);
                ASSERT_GT(shared::texelCoverage(wordAt(glm::ivec2(x, y) + step)), 0u) << x << ", " << y;
                for (int j = std::max(y - 3, 0); j <= std::min(y + 3, size.y - 1); ++j)
                    for (int i = std::max(x - 3, 0); i <= std::min(x + 3, size.x - 1); ++i)
                        if (shared::texelCoverage(wordAt({i, j})) > 0) {
                            ASSERT_LE(step.x * step.x + step.y * step.y,
                                      (i - x) * (i - x) + (j - y) * (j - y));
                        }
            }
    }
    EXPECT_GT(gutters, 100);
}

TEST(PackedTexels, MasksNameTheQuadsWithSurfaceOrGutterAndTheCovered)
{
    int wholeQuads = 0;
    const TexelMap map = scatteredMap({128, 64});
    const PackedTexels packed = pack(map);
    for (uint32_t level = 0; level < map.levels; ++level) {
        const glm::uvec2 size = map.levelSize(level), tiles = (size + 7u) / 8u;
        for (uint32_t tile = 0; tile < tiles.x * tiles.y; ++tile) {
            uint32_t any = 0, whole = shared::kAllQuads;
            for (uint32_t i = 0; i < 64; ++i) {
                const uint32_t x = tile % tiles.x * 8 + i % 8, y = tile / tiles.x * 8 + i / 8;
                if (x >= size.x || y >= size.y)
                    continue;
                const uint32_t quad = 1u << (i / 8 / 2 * 4 + i % 8 / 2);
                any |= map.at(level, x, y) != 0 ? quad : 0u;
                if (map.at(level, x, y) >> shared::kTexelCoverageShift < 253)
                    whole &= ~quad;
            }
            wholeQuads += std::popcount(whole & any);
            ASSERT_EQ(packed.words[packed.offsets[level] + size.x * size.y + tile], any | whole << 16)
                << level << ", " << tile;
        }
    }
    EXPECT_GT(wholeQuads, 20);
}

} // namespace
