// Lumel grids of meshes that are lit at other UVs than their material's.
#include "../scene/shapes.h"
#include "charts/unwrap.h"
#include "tsl/texel_map.h"
#include <gtest/gtest.h>
#include <map>

namespace lumel::tsl {
namespace {

scene::Mesh unwrapped(scene::Mesh mesh)
{
    scene::apply(scene::unwrap(mesh), mesh);
    return mesh;
}

TEST(LumelGrid, FollowsTheMaterialsDensity)
{
    // A plane whose lit UVs cover a quarter of the texture.
    scene::Mesh plane = scene::gridShape(1, 1, [](float s, float t) { return glm::vec3(s, -t, 0); });
    for (scene::Vertex& v : plane.vertices)
        v.uv = 0.5f * v.materialUv;
    const auto gridAt = [&](float tiles, int texels) {
        scene::Mesh mesh = plane;
        for (scene::Vertex& v : mesh.vertices)
            v.materialUv *= tiles;
        return lumelGrid(mesh, glm::ivec2(texels), glm::ivec2(1));
    };
    EXPECT_EQ(gridAt(1.0f, 512), glm::uvec2(2048)); // 1024 lumels across, as if lit at the material's UVs
    EXPECT_EQ(gridAt(2.0f, 256), glm::uvec2(2048));
    EXPECT_EQ(gridAt(4.0f, 256), glm::uvec2(4096));
    EXPECT_EQ(gridAt(100.0f, 1024), glm::uvec2(kMaxOwnGrid));
    EXPECT_EQ(gridAt(1.0f, 1), glm::uvec2(kMinGrid));
    EXPECT_EQ(gridAt(0.0f, 64), glm::uvec2(kMinGrid)); // maps read at one point
}

// No lumel within reach of a cubic filter's taps around a chart belongs to another one.
TEST(LumelGrid, ChartsKeepClearOfEachOthersFilterTaps)
{
    for (const scene::Mesh& shape :
         {scene::cubeShape(), scene::torusShape(), scene::rampShape(), scene::soupShape(3, 600)}) {
        const scene::Mesh mesh = unwrapped(shape);
        const glm::uvec2 size = lumelGrid(mesh, glm::ivec2(64), glm::ivec2(1));
        EXPECT_GE(mesh.unwrapped->gap * float(size.x), 4.0f);
        // Vertices of a chart share indices or places; charts share neither.
        std::map<std::pair<float, float>, uint32_t> places;
        std::vector<uint32_t> parent(mesh.vertices.size());
        const auto root = [&](uint32_t i) {
            while (parent[i] != i)
                i = parent[i];
            return i;
        };
        for (uint32_t i = 0; i < parent.size(); ++i)
            parent[i] = places.try_emplace({mesh.vertices[i].uv.x, mesh.vertices[i].uv.y}, i).first->second;
        for (size_t i = 0; i + 2 < mesh.indices.size(); i += 3)
            for (size_t c = 1; c < 3; ++c)
                parent[root(mesh.indices[i + c])] = root(mesh.indices[i]);
        const TexelMap map = makeTexelMap(mesh, size);
        const auto chartAt = [&](int x, int y) { // 0: none
            if (x < 0 || y < 0 || x >= int(size.x) || y >= int(size.y))
                return 0u;
            const uint32_t texel = map.at(0, uint32_t(x), uint32_t(y));
            return texel >> shared::kTexelCoverageShift
                       ? root(mesh.indices[3 * ((texel & shared::kTexelTriangleMask) - 1)]) + 1
                       : 0u;
        };
        int covered = 0, close = 0;
        for (int y = 0; y < int(size.y); ++y)
            for (int x = 0; x < int(size.x); ++x) {
                const uint32_t own = chartAt(x, y);
                covered += own != 0;
                for (int reach = -3; own && reach <= 3; ++reach)
                    for (const uint32_t other : {chartAt(x + 3, y + reach), chartAt(x + reach, y + 3)})
                        close += other != 0 && other != own;
            }
        EXPECT_EQ(close, 0);
        EXPECT_NEAR(float(covered) / float(size.x * size.y), mesh.unwrapped->coveredShare, 0.02f);
    }
}

// The smallest chart is drawn from lumels too.
TEST(LumelGrid, EveryTriangleOfAnUnwrappedMeshHasALumelNear)
{
    scene::Mesh shape = scene::cubeShape();
    for (int i = 0; i < 20; ++i) {
        const float x = 2.0f + 0.01f * float(i);
        scene::addTriangle(shape, {x, 0, 0}, {x, 0.0004f, 0}, {x, 0, 0.0004f});
    }
    const scene::Mesh mesh = unwrapped(shape);
    const TexelMap map = makeTexelMap(mesh, lumelGrid(mesh, glm::ivec2(1), glm::ivec2(1)));
    for (size_t i = 0; i < mesh.indices.size(); i += 3) {
        const glm::vec2 centre = (mesh.vertices[mesh.indices[i]].uv + mesh.vertices[mesh.indices[i + 1]].uv +
                                  mesh.vertices[mesh.indices[i + 2]].uv) /
                                 3.0f;
        const glm::uvec2 at(centre * glm::vec2(map.size));
        EXPECT_NE(map.at(0, at.x, at.y), 0u) << "triangle " << i / 3;
    }
}

} // namespace
} // namespace lumel::tsl
