// Three balls that become rounded cubes and twisted gourds in turn: one mesh, its morph targets weighted by
// each object's own animation.
#include "gltf_writer.h"
#include "noise.h"
#include "scenes.h"
#include <array>
#include <cmath>

namespace lumel::assets {
namespace {

constexpr float kRadius = 0.1f; // metres
constexpr float kSeconds = 9.0f;

// From the unit sphere to a shape of about its size.
using Form = glm::vec3 (*)(glm::vec3);

// Of a sphere in the norm of power 5 (a superellipsoid): a cube with round edges.
glm::vec3 cube(glm::vec3 n)
{
    constexpr float kPower = 5.0f;
    const glm::vec3 a = glm::abs(n);
    const float sum = std::pow(a.x, kPower) + std::pow(a.y, kPower) + std::pow(a.z, kPower);
    return 0.88f * n / std::pow(sum, 1.0f / kPower);
}

glm::vec3 gourd(glm::vec3 n)
{
    const float belt = 1.0f - n.y * n.y, angle = std::atan2(n.z, n.x) + 1.4f * n.y; // poles have no angle
    return n * (0.94f + 0.17f * belt * belt * std::cos(5.0f * angle)) * glm::vec3(1.0f, 1.08f, 1.0f);
}

// The ball's vertices where the form takes them, with its normals and tangents, by finite differences.
Shape formed(const Shape& ball, Form form)
{
    Shape shape = ball;
    for (Vertex& v : shape.vertices) {
        constexpr float kStep = 2e-3f;
        const glm::vec3 n = v.normal, t(v.tangent), b = glm::cross(n, t);
        const auto along = [&](glm::vec3 d) {
            return form(glm::normalize(n + kStep * d)) - form(glm::normalize(n - kStep * d));
        };
        const glm::vec3 alongT = along(t), alongB = along(b);
        v.position = kRadius * form(n);
        v.normal = glm::normalize(glm::cross(alongT, alongB));
        v.tangent = glm::vec4(tangentOf(alongT, alongB, v.normal), 1.0f);
    }
    return shape;
}

float relief(glm::vec2 texel)
{
    const glm::vec3 p = ballPoint(texel);
    float nearest = 1.0f;
    forNeighbours(8.0f * p, [&](const Scattered& point) {
        nearest = std::min(nearest, glm::dot(point.offset, point.offset));
    });
    return nearest + 0.04f * fbm3(24.0f * p, 2, 417);
}

} // namespace

void writeMorph(const std::filesystem::path& folder)
{
    GltfWriter gltf(folder, "morph");
    HeightMap height = makeHeight(kBallMap, relief);
    setSlope(height, 0.22f);
    const int hammered = gltf.addHeight("hammered", height);
    Shape shape = ball(kRadius, 28);
    shape.targets = {formed(shape, cube), formed(shape, gourd)};
    const int forms = gltf.addShape(shape);
    const std::array<MaterialLook, 3> looks{{
        {.baseColour = {0.95f, 0.55f, 0.38f}, .metallic = 1.0f, .power = 60.0f},
        {.baseColour = {0.03f, 0.16f, 0.30f}, .power = 220.0f},
        {.baseColour = {1.0f, 0.72f, 0.34f}, .metallic = 1.0f, .power = 110.0f},
    }};
    const std::array<const char*, 3> names{"copper", "enamel", "gold"};
    for (size_t i = 0; i < looks.size(); ++i) {
        MaterialLook look = looks[i];
        look.heightImage = hammered;
        const int node = gltf.addObject(
            names[i], forms, gltf.addMaterial(names[i], look),
            {.position = {2.45f * kRadius * (float(i) - 1.0f), 1.04f * kRadius, 0.0f}, .turnDegrees = 24.0f});
        // Ball, cube, gourd and again, each object a third of a round after the one before.
        std::vector<float> seconds;
        std::vector<std::vector<float>> weights;
        for (size_t k = 0; k <= 3; ++k) {
            const size_t form = (k + i) % 3;
            seconds.push_back(kSeconds * float(k) / 3.0f);
            weights.push_back({form == 1 ? 1.0f : 0.0f, form == 2 ? 1.0f : 0.0f});
        }
        gltf.weigh(node, seconds, weights);
    }
    const int floor = gltf.addMaterial("floor", {.baseColour = {0.05f, 0.045f, 0.045f}, .power = 9.0f});
    gltf.addObject("floor", gltf.addShape(floorGrid(8.0f, 8.0f, 8)), floor);
    gltf.addCamera("default", {0.0f, 0.27f, 0.80f}, {0.0f, 0.095f, 0.0f}, 36.0f, 0.02f);
    gltf.addCamera("near", {-0.16f, 0.22f, 0.42f}, {-0.11f, 0.1f, 0.0f}, 38.0f, 0.01f);
    gltf.addCamera("middle", {0.5f, 0.7f, 1.5f}, {0.0f, 0.07f, 0.0f}, 32.0f, 0.03f);
    gltf.addCamera("far", {0.8f, 1.2f, 3.2f}, {0.0f, 0.05f, 0.0f}, 26.0f, 0.05f);
    gltf.addDirectional("key", {-0.6f, 0.9f, 0.7f}, {1.0f, 0.92f, 0.80f}, 3.2f);
    gltf.addDirectional("rim", {0.8f, 0.5f, -0.6f}, {0.62f, 0.78f, 1.0f}, 3.0f);
    gltf.addDirectional("fill", {0.5f, 0.25f, 0.9f}, {0.9f, 0.95f, 1.0f}, 1.1f);
    gltf.write();
}

} // namespace lumel::assets
