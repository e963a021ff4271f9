#include "tsl/packed_texels.h"
#include <bit>
#include <gtest/gtest.h>
#include <random>
#include <set>

using namespace lumel;
using namespace lumel::tsl;

namespace {

void addTriangle(scene::Mesh& mesh, glm::vec2 a, glm::vec2 b, glm::vec2 c)
{
    for (const glm::vec2 uv : {a, b, c}) {
        mesh.indices.push_back(uint32_t(mesh.vertices.size()));
        mesh.vertices.push_back({.position = {},
                                 .normal = {0, 0, 1},
                                 .tangent = {1, 0, 0, 1},
                                 .uv = uv,
                                 .materialUv = uv,
                                 .emissionUv = uv});
    }
}

// Random small triangles, so that there are gutters of many shapes.
TexelMap scatteredMap(glm::uvec2 size)
{
    scene::Mesh mesh;
    std::mt19937 random(7);
    std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
    for (int i = 0; i < 12; ++i) {
        const glm::vec2 corner(0.9f * uniform(random), 0.9f * uniform(random));
        addTriangle(mesh, corner, corner + glm::vec2(0.1f, 0.02f), corner + glm::vec2(0.03f, 0.09f));
    }
    return makeTexelMap(mesh, size);
}

// A grid of squares, two triangles each, which cover all.
scene::Mesh squares(int across)
{
    scene::Mesh mesh;
    const float side = 1.0f / float(across);
    for (int i = 0; i < across * across; ++i) {
        const glm::vec2 a = side * glm::vec2(i % across, i / across), b = a + side;
        addTriangle(mesh, a, {b.x, a.y}, b);
        addTriangle(mesh, a, b, {a.x, b.y});
    }
    return mesh;
}

// As shaders read them: shaders/lib/tiles.glsl.
class Reader {
public:
    Reader(const TexelMap& map, const PackedTexels& packed) : map_(map), packed_(packed) {}

    const uint32_t* tile(uint32_t level, glm::uvec2 tile) const
    {
        const uint32_t across = (map_.levelSize(level).x + 7) / 8;
        return &packed_.words.at(packed_.offsets[level] + 2 * (tile.y * across + tile.x));
    }
    uint32_t at(uint32_t level, glm::uvec2 lumel) const
    {
        const uint32_t texels = tile(level, lumel / 8u)[1];
        if (!(texels & shared::kTexelsListed))
            return texels;
        const uint32_t first = texels & shared::kTexelListMask, bits = shared::texelListBits(texels);
        const uint32_t bit = shared::texelPlace(lumel) * bits, word = packed_.words.at(first + bit / 32);
        return bits == 32 ? word
                          : packed_.words.at(first + 2 * bits + (word >> bit % 32 & ((1u << bits) - 1)));
    }

private:
    const TexelMap& map_;
    const PackedTexels& packed_;
};

void expectTheMaps(const TexelMap& map)
{
    const PackedTexels packed = pack(map);
    const Reader reader(map, packed);
    for (uint32_t level = 0; level < map.levels; ++level)
        for (uint32_t i = 0; i < map.levelSize(level).x * map.levelSize(level).y; ++i) {
            const uint32_t raw = map.texels[map.offsets[level] + i], width = map.levelSize(level).x,
                           texel = reader.at(level, {i % width, i / width});
            ASSERT_EQ(texel & shared::kTexelTriangleMask, raw & shared::kTexelTriangleMask);
            const uint32_t coverage = raw >> shared::kTexelCoverageShift;
            ASSERT_NEAR(float(shared::texelCoverage(texel)) / 127.0f, float(coverage) / 255.0f, 0.01f);
            ASSERT_EQ(shared::texelCoverage(texel) > 0, coverage > 0);
        }
}

TEST(PackedTexels, TrianglesAndCoverageAreTheMaps)
{
    expectTheMaps(scatteredMap({128, 64}));
    expectTheMaps(scatteredMap({4, 1024}));
    expectTheMaps(makeTexelMap(squares(40), {256, 256}));
}

// From one triangle a tile to more than a list has numbers for.
TEST(PackedTexels, TilesAreListedByTheirNumberOfTexels)
{
    std::set<uint32_t> bits; // 0: of one texel
    for (const int across : {1, 24, 64, 120}) {
        const TexelMap map = makeTexelMap(squares(across), {256, 256});
        const PackedTexels packed = pack(map);
        const Reader reader(map, packed);
        for (uint32_t i = 0; i < 32 * 32; ++i) {
            const uint32_t texels = reader.tile(0, {i % 32, i / 32})[1];
            bits.insert(texels & shared::kTexelsListed ? shared::texelListBits(texels) : 0);
        }
    }
    EXPECT_EQ(bits, (std::set<uint32_t>{0, 1, 2, 4, 32}));
}

// 4 bytes a lumel over all levels would be 358 MB.
TEST(PackedTexels, TakesASmallPartOfALargeMap)
{
    const auto megabytes = [](int across) {
        return 4e-6 * double(pack(makeTexelMap(squares(across), glm::uvec2(kMaxGrid))).words.size());
    };
    EXPECT_LT(megabytes(16), 20.0);  // 512 triangles
    EXPECT_LT(megabytes(256), 60.0); // 131,072
}

// Against a search of all lumels around.
TEST(PackedTexels, GuttersNameTheNearestCoveredLumel)
{
    const TexelMap map = scatteredMap({128, 64});
    const PackedTexels packed = pack(map);
    const Reader reader(map, packed);
    int gutters = 0;
    for (uint32_t level = 0; level < map.levels; ++level) {
        const glm::ivec2 size(map.levelSize(level));
        const auto wordAt = [&](glm::ivec2 p) { return reader.at(level, glm::uvec2(p)); };
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
    const Reader reader(map, packed);
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
            ASSERT_EQ(reader.tile(level, {tile % tiles.x, tile / tiles.x})[0], any | whole << 16)
                << level << ", " << tile;
        }
    }
    EXPECT_GT(wholeQuads, 20);
}

} // namespace
