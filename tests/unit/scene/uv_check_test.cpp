#include "charts/uv_check.h"
#include <chrono>
#include <gtest/gtest.h>
#include <random>

namespace lumel::scene {
namespace {

struct UvMesh : Mesh {
    void add(glm::vec2 a, glm::vec2 b, glm::vec2 c)
    {
        for (glm::vec2 uv : {a, b, c}) {
            Vertex v{};
            v.uv = uv;
            indices.push_back(uint32_t(vertices.size()));
            vertices.push_back(v);
        }
    }
    void rectangle(float x0, float y0, float x1, float y1)
    {
        add({x0, y0}, {x1, y0}, {x1, y1});
        add({x0, y0}, {x1, y1}, {x0, y1});
    }
    // n x n cells of two triangles, vertices moved about within their cells: nothing overlaps.
    void jitteredGrid(int n, glm::vec2 lower, glm::vec2 upper, unsigned seed)
    {
        std::mt19937 random(seed);
        std::uniform_real_distribution<float> shift(-0.2f, 0.2f);
        std::vector<glm::vec2> points;
        for (int y = 0; y <= n; ++y)
            for (int x = 0; x <= n; ++x) {
                glm::vec2 p(x, y);
                if (x > 0 && x < n && y > 0 && y < n)
                    p += glm::vec2(shift(random), shift(random));
                points.push_back(lower + p / float(n) * (upper - lower));
            }
        const auto at = [&](int x, int y) { return points[size_t(y) * size_t(n + 1) + size_t(x)]; };
        for (int y = 0; y < n; ++y)
            for (int x = 0; x < n; ++x) {
                add(at(x, y), at(x + 1, y), at(x + 1, y + 1));
                add(at(x, y), at(x + 1, y + 1), at(x, y + 1));
            }
    }
};

TEST(UvCheck, TouchingTrianglesDoNotOverlap)
{
    UvMesh mesh;
    mesh.rectangle(0.0f, 0.0f, 0.5f, 0.5f);             // shared diagonal
    mesh.rectangle(0.5f, 0.0f, 1.0f, 0.5f);             // shared edge
    mesh.rectangle(0.5f, 0.5f, 1.0f, 1.0f);             // shared corner and edge
    mesh.add({0.0f, 0.5f}, {0.3f, 0.5f}, {0.0f, 1.0f}); // part of an edge: a T-junction
    EXPECT_EQ(findUvProblem(mesh), "");
    EXPECT_EQ(findUvOverlap(mesh).repeated, 0.0);
    EXPECT_NEAR(findUvOverlap(mesh).covered, 0.75 + 0.075, 1e-7);
}

TEST(UvCheck, FansAroundAVertexDoNotOverlap)
{
    for (int n : {3, 7, 100, 1000}) {
        UvMesh mesh;
        for (int i = 0; i < n; ++i) {
            const auto rim = [&](int k) {
                const double angle = 2.0 * 3.14159265358979 * (k % n) / n;
                return glm::vec2(0.5 + 0.4 * std::cos(angle), 0.5 + 0.4 * std::sin(angle));
            };
            mesh.add({0.5f, 0.5f}, rim(i), rim(i + 1));
        }
        EXPECT_EQ(findUvProblem(mesh), "") << n;
    }
}

TEST(UvCheck, MirroredOverlapIsFound)
{
    // Both halves of a symmetric model on the same part of the texture, one wound the other way.
    UvMesh mesh;
    mesh.rectangle(0.1f, 0.1f, 0.6f, 0.9f);
    mesh.add({0.1f, 0.1f}, {0.6f, 0.9f}, {0.6f, 0.1f});
    mesh.add({0.1f, 0.1f}, {0.1f, 0.9f}, {0.6f, 0.9f});
    EXPECT_EQ(findUvProblem(mesh), "UVs overlap by 100.0 %");
}

TEST(UvCheck, ShareIsExact)
{
    UvMesh mesh;
    mesh.rectangle(0.0f, 0.0f, 0.5f, 0.5f);     // area 1/4
    mesh.rectangle(0.25f, 0.25f, 0.75f, 0.75f); // 1/4, of which 1/16 on top of the first
    const UvOverlap overlap = findUvOverlap(mesh);
    EXPECT_NEAR(overlap.repeated, 1.0 / 16.0, 1e-12);
    EXPECT_NEAR(overlap.covered, 7.0 / 16.0, 1e-12);
    EXPECT_EQ(findUvProblem(mesh), "UVs overlap by 14.3 %"); // 1/7
}

TEST(UvCheck, LayersCountOnceHoweverMany)
{
    UvMesh mesh;
    mesh.rectangle(0.0f, 0.0f, 1.0f, 0.5f);
    for (int i = 0; i < 5; ++i)
        mesh.rectangle(0.0f, 0.0f, 0.25f, 0.5f);
    const UvOverlap overlap = findUvOverlap(mesh);
    EXPECT_NEAR(overlap.repeated, 0.125, 1e-12);
    EXPECT_NEAR(overlap.covered, 0.5, 1e-12);
}

TEST(UvCheck, TriangleInsideAnotherIsFound)
{
    UvMesh mesh;
    mesh.add({0, 0}, {1, 0}, {0, 1});
    mesh.add({0.2f, 0.2f}, {0.3f, 0.2f}, {0.2f, 0.3f}); // no edges cross
    EXPECT_NEAR(findUvOverlap(mesh).repeated, 0.005, 1e-9);
    UvMesh crossing; // no vertex of one lies in the other: a star
    crossing.add({0.1f, 0.3f}, {0.9f, 0.3f}, {0.5f, 0.9f});
    crossing.add({0.1f, 0.7f}, {0.5f, 0.1f}, {0.9f, 0.7f});
    EXPECT_GT(findUvOverlap(crossing).share(), 0.3);
}

TEST(UvCheck, AgreesWithCountingPoints)
{
    std::mt19937 random(7);
    std::uniform_real_distribution<float> unit(0.0f, 1.0f);
    UvMesh mesh;
    for (int i = 0; i < 40; ++i) {
        const glm::vec2 p(unit(random), unit(random));
        const auto near = [&] {
            return glm::clamp(p + 0.5f * glm::vec2(unit(random) - 0.5f, unit(random) - 0.5f), 0.0f, 1.0f);
        };
        mesh.add(near(), near(), near());
    }
    constexpr int kSize = 1000;
    int covered = 0, repeated = 0;
    for (int y = 0; y < kSize; ++y)
        for (int x = 0; x < kSize; ++x) {
            const glm::dvec2 p((x + 0.5) / kSize, (y + 0.5) / kSize);
            int layers = 0;
            for (size_t i = 0; i < mesh.vertices.size(); i += 3) {
                double side[3];
                for (size_t e = 0; e < 3; ++e) {
                    const glm::dvec2 a(mesh.vertices[i + e].uv), b(mesh.vertices[i + (e + 1) % 3].uv);
                    side[e] = (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
                }
                layers += (side[0] > 0 && side[1] > 0 && side[2] > 0) ||
                          (side[0] < 0 && side[1] < 0 && side[2] < 0);
            }
            covered += layers > 0;
            repeated += layers > 1;
        }
    const UvOverlap overlap = findUvOverlap(mesh);
    EXPECT_NEAR(overlap.covered, double(covered) / (kSize * kSize), 2e-4);
    EXPECT_NEAR(overlap.repeated, double(repeated) / (kSize * kSize), 2e-4);
}

TEST(UvCheck, LeavingTheTextureIsFound)
{
    for (glm::vec2 outside :
         {glm::vec2(1.01f, 0.5f), glm::vec2(-0.01f, 0.5f), glm::vec2(0.5f, 1.01f), glm::vec2(0.5f, -0.01f)}) {
        UvMesh mesh;
        mesh.add({0.2f, 0.2f}, {0.3f, 0.4f}, outside);
        EXPECT_EQ(findUvProblem(mesh), "UVs leave [0, 1]");
    }
    UvMesh rounded; // rounding of exporters
    rounded.add({-0.00005f, 0.0f}, {1.00005f, 0.0f}, {0.0f, 1.00005f});
    EXPECT_EQ(findUvProblem(rounded), "");
}

TEST(UvCheck, DegenerateTrianglesOverlapNothing)
{
    UvMesh mesh;
    mesh.rectangle(0, 0, 1, 1);
    mesh.add({0.5f, 0.5f}, {0.5f, 0.5f}, {0.5f, 0.5f});
    mesh.add({0.1f, 0.1f}, {0.5f, 0.5f}, {0.9f, 0.9f});
    EXPECT_EQ(findUvProblem(mesh), "");
}

TEST(UvCheck, UvsWithoutAreaAreNamed)
{
    UvMesh mesh;
    mesh.add({0.5f, 0.5f}, {0.5f, 0.5f}, {0.5f, 0.5f});
    mesh.add({0.1f, 0.1f}, {0.5f, 0.5f}, {0.9f, 0.9f});
    EXPECT_EQ(findUvProblem(mesh), "UVs cover no area");
}

TEST(UvCheck, OverlapOfLessThanATileOfLumelsIsAccepted)
{
    for (float lumels : {6.0f, 10.0f}) { // squares of that many lumels of 4096^2
        UvMesh mesh;
        mesh.rectangle(0, 0, 0.5f, 0.5f);
        mesh.rectangle(0.25f, 0.25f, 0.25f + lumels / 4096.0f, 0.25f + lumels / 4096.0f);
        EXPECT_EQ(findUvProblem(mesh).empty(), lumels < 8.0f);
    }
}

TEST(UvCheck, FineMeshesOnTopOfEachOtherAreFound)
{
    // Each triangle is smaller than a lumel; the two sheets are congruent.
    UvMesh mesh;
    mesh.jitteredGrid(60, {0.2f, 0.2f}, {0.21f, 0.21f}, 1);
    EXPECT_EQ(findUvProblem(mesh), "");
    mesh.jitteredGrid(60, {0.2f, 0.2f}, {0.21f, 0.21f}, 1);
    EXPECT_EQ(findUvProblem(mesh), "UVs overlap by 100.0 %");
}

TEST(UvCheck, HundredThousandTrianglesTakeWellUnderASecond)
{
    UvMesh mesh;
    mesh.jitteredGrid(224, {0, 0}, {1, 1}, 2); // 100352 triangles
    const auto start = std::chrono::steady_clock::now();
    EXPECT_EQ(findUvProblem(mesh), "");
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    EXPECT_LT(seconds.count(), 3.0); // 0.02 s without sanitizers on an idle machine
}

TEST(UvCheck, EntangledMeshesEndInBoundedTime)
{
    // Every triangle crosses every other: the exact figure would take minutes.
    UvMesh mesh;
    for (int i = 0; i < 30000; ++i) {
        const float angle = 3.14159f * float(i) / 30000.0f;
        const glm::vec2 direction = 0.5f * glm::vec2(std::cos(angle), std::sin(angle));
        mesh.add(glm::vec2(0.5f) - direction, glm::vec2(0.5f) + direction,
                 glm::clamp(glm::vec2(0.5f) + direction + 0.01f * glm::vec2(-direction.y, direction.x), 0.0f,
                            1.0f));
    }
    const auto start = std::chrono::steady_clock::now();
    EXPECT_TRUE(findUvProblem(mesh).starts_with("UVs overlap by at least "));
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    EXPECT_LT(seconds.count(), 20.0); // one second on an idle machine
}

} // namespace
} // namespace lumel::scene
