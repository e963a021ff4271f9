// A row of balls, each with its own relief: they tell methods of filtering relief apart.
#include "brick.h"
#include "gltf_writer.h"
#include "scenes.h"
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <tbb/parallel_for.h>

namespace lumel::assets {
namespace {

constexpr float kPi = float(std::numbers::pi);
constexpr float kRadius = 0.1f; // metres

// Reliefs and colours are functions of the point on the unit sphere, so charts meet without a seam.

// Round bumps of many sizes over gentle waves, like cast iron under enamel.
float bumpy(glm::vec3 p)
{
    float height = 0.10f * fbm3(5.0f * p, 2, 61);
    forNeighbours(9.0f * p, [&](const Scattered& point) {
        const float reach = 0.35f + 0.6f * random01(point.id, 4); // in cells
        const float t = glm::max(1.0f - glm::dot(point.offset, point.offset) / (reach * reach), 0.0f);
        height += 0.5f * reach * t * t;
    });
    return height;
}

// Scratches are thin grooves along pieces of circles on the sphere: planes that cut it.
float scratched(glm::vec3 p)
{
    constexpr int kScratches = 260;
    float height = 0.06f * fbm3(5.0f * p, 2, 71);
    for (int i = 0; i < kScratches; ++i) {
        const float z = 2.0f * random01(i, 1) - 1.0f, angle = 2.0f * kPi * random01(i, 2);
        const glm::vec3 axis(std::sqrt(1.0f - z * z) * std::cos(angle), z,
                             std::sqrt(1.0f - z * z) * std::sin(angle));
        const float offset = 1.2f * random01(i, 3) - 0.6f;
        const float across = glm::dot(p, axis) - offset; // radians, nearly
        constexpr float kWidth = 0.0075f;                // 1.5 texels
        if (std::abs(across) > 4.0f * kWidth)
            continue;
        // Each covers part of its circle and thins out towards its ends.
        const glm::vec3 u = glm::normalize(glm::cross(axis, glm::vec3(0.31f, 0.7f, 0.64f))),
                        v = glm::cross(axis, u);
        const float along = std::atan2(glm::dot(p, v), glm::dot(p, u));
        const float reach = 0.4f + 1.6f * random01(i, 4);
        const float fading = smooth(reach, 0.6f * reach, std::abs(along));
        const float t = across / kWidth;
        height -= (0.3f + 0.7f * random01(i, 5)) * fading * (1.0f - 0.35f * t * t) * std::exp(-0.5f * t * t);
    }
    return height;
}

// Bricks in rings of latitude; each ring has a whole number of bricks, a round one closes each pole.
BrickPlace brickOnBall(glm::vec3 p)
{
    constexpr int kRows = 13;
    const float rowHeight = kPi / float(kRows); // radians
    const float polar = std::acos(glm::clamp(p.y, -1.0f, 1.0f));
    const int row = std::min(int(polar / rowHeight), kRows - 1);
    if (row == 0 || row == kRows - 1) {
        const float r = (row == 0 ? polar : kPi - polar) / rowHeight;
        return {{r, 0.0f}, {1.0f, 10.0f}, row};
    }
    const float ring = std::sin((float(row) + 0.5f) * rowHeight); // radius at the row's middle
    const int count = std::max(3, int(std::round(kPi * ring / rowHeight)));
    const float turn = std::atan2(p.z, p.x) / (2.0f * kPi) + 0.5f;
    const float along = turn * float(count) + (row % 2 ? 0.5f : 0.0f);
    const float column = std::floor(along);
    const float halfLength = kPi * ring / rowHeight / float(count);
    const glm::vec2 local((along - column - 0.5f) * 2.0f * halfLength, polar / rowHeight - float(row) - 0.5f);
    return {local, {halfLength, 0.5f}, row * 100 + int(column) % count};
}

float bricked(glm::vec3 p)
{
    return brickHeight(brickOnBall(p), 4.1f * p); // 13 rows over pi radians: 4.1 bricks per unit
}

// Hammer blows: overlapping shallow dents around scattered points, one in each cell of a lattice.
float hammered(glm::vec3 p)
{
    constexpr float kCells = 9.0f; // across the radius
    float nearest = std::numeric_limits<float>::max();
    forNeighbours(kCells * p, [&](const Scattered& point) {
        nearest = std::min(nearest, glm::dot(point.offset, point.offset));
    });
    return std::min(nearest, 1.0f) + 0.05f * fbm3(3.0f * kCells * p, 2, 79);
}

// Brushed around the vertical axis: noise that is fine in latitude and long in longitude.
float brushed(glm::vec3 p)
{
    const float turn = std::atan2(p.z, p.x) / (2.0f * kPi) + 0.5f;
    const float latitude = std::asin(glm::clamp(p.y, -1.0f, 1.0f));
    return 0.7f * noise2({14.0f * turn, latitude * 95.0f}, 83, 14) +
           0.5f * noise2({37.0f * turn, latitude * 60.0f}, 89, 37) +
           0.6f * noise2({5.0f * turn, latitude * 31.0f}, 97, 5);
}

struct BallLook {
    const char* name;
    float (*relief)(glm::vec3);
    float slopeRms;
    MaterialLook look;
    bool brickColours = false;
};

const std::array<BallLook, 5> kBalls{{
    {"bumpy", bumpy, 0.38f, {.baseColour = {0.02f, 0.10f, 0.30f}, .power = 260.0f}},
    {"scratched", scratched, 0.22f, {.baseColour = {0.60f, 0.61f, 0.63f}, .metallic = 1.0f, .power = 90.0f}},
    {"bricks", bricked, 0.40f, {.baseColour = glm::vec3(1.0f), .power = 60.0f}, true},
    {"hammered", hammered, 0.28f, {.baseColour = {0.93f, 0.52f, 0.36f}, .metallic = 1.0f, .power = 50.0f}},
    {"brushed", brushed, 0.25f, {.baseColour = {1.0f, 0.66f, 0.34f}, .metallic = 1.0f, .power = 90.0f}},
}};

} // namespace

void writeBalls(const std::filesystem::path& folder)
{
    GltfWriter gltf(folder, "balls");
    std::array<HeightMap, kBalls.size()> reliefs;
    tbb::parallel_for(size_t(0), kBalls.size(), [&](size_t i) {
        reliefs[i] =
            makeHeight(kBallMap, [&](glm::vec2 texel) { return kBalls[i].relief(ballPoint(texel)); });
        setSlope(reliefs[i], kBalls[i].slopeRms);
    });
    const Image brickColours = makeColour(kBallMap, [](glm::vec2 texel) {
        const glm::vec3 p = ballPoint(texel);
        return brickColour(brickOnBall(p), 4.1f * p);
    });
    const int shape = gltf.addShape(ball(kRadius, 32));
    for (size_t i = 0; i < kBalls.size(); ++i) {
        MaterialLook look = kBalls[i].look;
        look.heightImage = gltf.addHeight(kBalls[i].name, reliefs[i]);
        if (kBalls[i].brickColours)
            look.colourImage = gltf.addColour(kBalls[i].name, brickColours);
        const int material = gltf.addMaterial(kBalls[i].name, look);
        gltf.addObject(kBalls[i].name, shape, material,
                       {.position = {2.3f * kRadius * (float(i) - 2.0f), kRadius, 0.0f}});
    }
    const int floor = gltf.addMaterial("floor", {.baseColour = {0.06f, 0.06f, 0.065f}, .power = 30.0f});
    gltf.addObject("floor", gltf.addShape(floorGrid(12.0f, 12.0f, 8)), floor);

    gltf.addCamera("default", {0.0f, 0.26f, 1.05f}, {0.0f, 0.09f, 0.0f}, 40.0f, 0.02f);
    gltf.addCamera("near", {0.10f, 0.17f, 0.40f}, {0.02f, 0.095f, 0.0f}, 40.0f, 0.01f);
    gltf.addCamera("far", {0.6f, 1.1f, 3.6f}, {0.0f, 0.05f, 0.0f}, 30.0f, 0.05f);
    gltf.addCamera("middle", {0.45f, 0.62f, 1.9f}, {0.0f, 0.06f, 0.0f}, 34.0f, 0.03f);
    gltf.addDirectional("key", {-0.6f, 0.9f, 0.7f}, {1.0f, 0.94f, 0.84f}, 3.2f);
    gltf.addDirectional("rim", {0.8f, 0.5f, -0.6f}, {0.65f, 0.80f, 1.0f}, 3.0f);
    gltf.addDirectional("fill", {0.5f, 0.25f, 0.9f}, {0.9f, 0.95f, 1.0f}, 1.1f);
    gltf.write();
}

} // namespace lumel::assets
