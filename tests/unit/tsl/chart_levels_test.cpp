// Chart levels: down to which level a mesh's charts keep clear of each other.
#include "tsl/chart_levels.h"
#include <gtest/gtest.h>

namespace lumel::tsl {
namespace {

// n x n squares in space and in the texture, `gap` apart there; neighbours in the texture are none in space.
scene::Mesh squares(int n, float gap, bool joined)
{
    scene::Mesh mesh;
    for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) {
            const auto first = uint32_t(mesh.vertices.size());
            for (int corner = 0; corner < 4; ++corner) {
                const glm::vec2 at(corner & 1, corner >> 1);
                const glm::vec2 uv =
                    (glm::vec2(x, y) + glm::mix(glm::vec2(gap), glm::vec2(1 - gap), at)) / float(n);
                shared::Vertex vertex{};
                vertex.position = joined ? glm::vec3(uv, 0.0f) : glm::vec3(at + 2.0f * glm::vec2(x, y), 0.0f);
                vertex.uv = uv;
                mesh.vertices.push_back(vertex);
            }
            for (const uint32_t i : {0u, 1u, 2u, 2u, 1u, 3u})
                mesh.indices.push_back(first + i);
        }
    return mesh;
}

uint32_t coarsest(const scene::Mesh& mesh)
{
    return coarsestWithoutSeams(seamShares(mesh, makeTexelMap(mesh, {256, 256})));
}

TEST(ChartLevels, OneChartHasNoSeams)
{
    EXPECT_EQ(coarsest(squares(1, 0.0f, true)), 8u);
    EXPECT_EQ(coarsest(squares(4, 0.0f, true)), 8u); // separate vertices, but one surface
}

TEST(ChartLevels, GuttersLastForTheLogarithmOfTheirWidth)
{
    // Charts in cells of 32 lumels. Where half a gutter is less than a lumel, lumels of two charts meet.
    EXPECT_EQ(coarsest(squares(8, 1.0f / 32.0f, false)), 0u);
    EXPECT_EQ(coarsest(squares(8, 2.0f / 32.0f, false)), 1u);
    EXPECT_EQ(coarsest(squares(8, 4.0f / 32.0f, false)), 2u);
}

TEST(ChartLevels, SmallChartsWithoutGuttersMixAtOnce)
{
    EXPECT_EQ(coarsest(squares(32, 0.0f, false)), 0u);
    const auto shares =
        seamShares(squares(32, 0.0f, false), makeTexelMap(squares(32, 0.0f, false), {256, 256}));
    EXPECT_NEAR(shares[0], 1.0f - 36.0f / 64.0f, 0.03f); // the outer ring of 8 x 8 lumels
    EXPECT_EQ(shares[3], 1.0f);
}

} // namespace
} // namespace lumel::tsl
