// Meshes made in code for the tests of unwrapping: positions and indices; UVs all 0 unless said.
#pragma once
#include "scene/scene.h"
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

namespace lumel::scene {

inline void addTriangle(Mesh& mesh, glm::vec3 a, glm::vec3 b, glm::vec3 c)
{
    for (const glm::vec3 p : {a, b, c}) {
        Vertex v{};
        v.position = p;
        v.normal = {0, 0, 1};
        mesh.indices.push_back(uint32_t(mesh.vertices.size()));
        mesh.vertices.push_back(v);
    }
}

// (columns + 1) x (rows + 1) shared vertices at at(s, t), s and t in [0, 1]; materialUv = (s, t).
inline Mesh gridShape(int columns, int rows, const std::function<glm::vec3(float, float)>& at)
{
    Mesh mesh;
    for (int y = 0; y <= rows; ++y)
        for (int x = 0; x <= columns; ++x) {
            Vertex v{};
            v.materialUv = {float(x) / float(columns), float(y) / float(rows)};
            v.position = at(v.materialUv.x, v.materialUv.y);
            mesh.vertices.push_back(v);
        }
    for (int y = 0; y < rows; ++y)
        for (int x = 0; x < columns; ++x) {
            const auto a = uint32_t(y * (columns + 1) + x), b = a + 1, c = a + uint32_t(columns) + 1,
                       d = c + 1;
            mesh.indices.insert(mesh.indices.end(), {a, c, d, a, d, b});
        }
    return mesh;
}

inline constexpr float kTurn = 2.0f * std::numbers::pi_v<float>;

inline Mesh cubeShape()
{
    Mesh mesh;
    for (int axis = 0; axis < 3; ++axis)
        for (const float side : {-1.0f, 1.0f}) {
            const auto at = [&](float s, float t) {
                glm::vec3 p;
                p[axis] = side;
                p[(axis + 1) % 3] = side * s;
                p[(axis + 2) % 3] = t;
                return p;
            };
            addTriangle(mesh, at(-1, -1), at(1, -1), at(1, 1));
            addTriangle(mesh, at(-1, -1), at(1, 1), at(-1, 1));
        }
    return mesh;
}

inline Mesh sphereShape(int columns = 48, int rows = 24)
{
    return gridShape(columns, rows, [](float s, float t) {
        const float phi = kTurn * s, theta = 0.5f * kTurn * t;
        return glm::vec3(std::sin(theta) * std::sin(phi), std::cos(theta), std::sin(theta) * std::cos(phi));
    });
}

inline Mesh torusShape(int columns = 64, int rows = 32)
{
    return gridShape(columns, rows, [](float s, float t) {
        const float r = 2.0f + 0.7f * std::cos(kTurn * t);
        return glm::vec3(r * std::sin(kTurn * s), 0.7f * std::sin(kTurn * t), r * std::cos(kTurn * s));
    });
}

// A strip turned by half: its two ends meet with opposite winding.
inline Mesh moebiusShape()
{
    return gridShape(60, 6, [](float s, float t) {
        const float half = 0.5f * kTurn * s, w = t - 0.5f;
        const float r = 1.0f + w * std::cos(half);
        return glm::vec3(r * std::cos(kTurn * s), r * std::sin(kTurn * s), w * std::sin(half));
    });
}

// A ramp that winds three times over itself: nearly level everywhere, so that its normals alone are one
// chart.
inline Mesh rampShape()
{
    return gridShape(180, 2, [](float s, float t) {
        const float r = 1.0f + 0.5f * t, angle = 3.0f * kTurn * s;
        return glm::vec3(r * std::cos(angle), 0.5f * s, -r * std::sin(angle));
    });
}

inline Mesh soupShape(unsigned seed, int triangles)
{
    Mesh mesh;
    std::mt19937 random(seed);
    const auto point = [&] {
        const auto coordinate = [&] { return float(random() % 10000) / 5000.0f - 1.0f; };
        const float x = coordinate(), y = coordinate(), z = coordinate();
        return glm::vec3(x, y, z);
    };
    for (int i = 0; i < triangles; ++i) {
        const glm::vec3 a = point(), b = point(), c = point();
        addTriangle(mesh, a, b, c);
    }
    return mesh;
}

inline void append(Mesh& mesh, const Mesh& other)
{
    const auto first = uint32_t(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
    for (const uint32_t index : other.indices)
        mesh.indices.push_back(first + index);
}

} // namespace lumel::scene
