// Five bronze tentacles that curl and sway: one mesh under five skins of nine joints.
#include "gltf_writer.h"
#include "noise.h"
#include "scenes.h"
#include <cmath>
#include <numbers>

namespace lumel::assets {
namespace {

constexpr float kTau = 2.0f * float(std::numbers::pi);
constexpr int kMap = 512; // texels
constexpr int kJoints = 9, kArms = 5;
constexpr float kLength = 0.64f; // metres
constexpr float kSpacing = kLength / float(kJoints - 1);
constexpr float kFoot = 0.055f, kTip = 0.008f; // radii
constexpr float kEdge = 0.03f;                 // of the map, beside the seam
constexpr float kSeconds = 6.0f;               // one round
constexpr int kAround = 28, kAlong = 96, kKeys = 24;

// Share of the length to the radius; a round tip.
float radiusAt(float s)
{
    const float r = glm::mix(kFoot, kTip, std::pow(s, 0.8f));
    const float end = (1.0f - s) * kLength / kTip; // in radii of the tip
    return end < 1.0f ? r * std::sqrt(std::max(1.0f - (1.0f - end) * (1.0f - end), 0.0f)) : r;
}

// u in [0, 1] around, away from the suckers' side to meet behind; s along.
glm::vec3 surfaceAt(float u, float s)
{
    const float angle = kTau * u, r = radiusAt(s);
    return {r * std::sin(angle), s * kLength, -r * std::cos(angle)};
}

Shape tentacle()
{
    Shape shape;
    for (int j = 0; j <= kAlong; ++j)
        for (int i = 0; i <= kAround; ++i) {
            const float u = float(i) / kAround, s = 1.0f - std::pow(1.0f - float(j) / kAlong, 1.15f);
            constexpr float kStep = 1e-3f;
            const float low = std::max(s - kStep, 0.0f), high = std::min(s + kStep, 0.9999f);
            const float slope = (radiusAt(high) - radiusAt(low)) / ((high - low) * kLength);
            const float angle = kTau * u;
            const glm::vec3 n = glm::normalize(glm::vec3(std::sin(angle), -slope, -std::cos(angle)));
            shape.add(surfaceAt(u, s), s < 1.0f ? n : glm::vec3(0, 1, 0),
                      {std::cos(angle), 0.0f, std::sin(angle)},
                      {glm::mix(kEdge, 1.0f - kEdge, u), glm::mix(1.0f - kEdge, kEdge, s)});
            // Two joints share a vertex: the part between them deforms smoothly.
            const float at = std::min(s * float(kJoints - 1), float(kJoints - 1) - 1e-3f);
            const auto joint = uint8_t(at);
            const float share = at - float(joint);
            shape.joints.push_back({joint, uint8_t(joint + 1), 0, 0});
            shape.weights.emplace_back(1.0f - share, share, 0.0f, 0.0f);
        }
    const uint32_t row = kAround + 1;
    for (uint32_t j = 0; j < kAlong; ++j)
        for (uint32_t i = 0; i < kAround; ++i)
            shape.quad(j * row + i, j * row + i + 1, (j + 1) * row + i + 1, (j + 1) * row + i);
    return shape;
}

struct Place {
    float u, s;
    glm::vec3 position;
};
Place underTexel(glm::vec2 texel)
{
    const glm::vec2 t = texel / float(kMap);
    const float u = (t.x - kEdge) / (1.0f - 2.0f * kEdge);
    const float s = glm::clamp((1.0f - kEdge - t.y) / (1.0f - 2.0f * kEdge), 0.0f, 1.0f);
    return {u, s, surfaceAt(u, s)};
}

// The suckers' two rows, smaller towards the tip: distance from the next one's middle in its radii.
float suckerAt(const Place& place)
{
    // Their sizes follow the radius, so their number grows with the integral of 1 / radius; nearly that:
    const float along = 9.0f * -std::log(1.0f - 0.86f * place.s);
    float nearest = 9.0f;
    for (const float side : {-1.0f, 1.0f}) {
        const float offset = side > 0.0f ? 0.5f : 0.0f;
        const float step = along + offset - std::floor(along + offset) - 0.5f;
        const float across = (place.u - 0.5f) * 7.2f - 0.55f * side;
        nearest = std::min(nearest, glm::length(glm::vec2(across, step)) / 0.44f);
    }
    return nearest;
}

float relief(glm::vec2 texel)
{
    const Place place = underTexel(texel);
    float dent = 1.0f;
    const glm::vec3 p = place.position * (0.6f / std::max(radiusAt(place.s) + 0.012f, 0.02f));
    forNeighbours(1.9f * p, [&](const Scattered& point) {
        dent = std::min(dent, glm::dot(point.offset, point.offset));
    });
    const float d = suckerAt(place);
    const float rim = std::exp(-14.0f * (d - 0.72f) * (d - 0.72f)), cup = smooth(0.66f, 0.2f, d);
    const float hammered = 0.5f * dent * smooth(0.8f, 1.3f, d);
    return hammered + 1.1f * rim - 0.5f * cup + 0.05f * fbm3(160.0f * place.position, 3, 311);
}

// Bronze with verdigris in the hollows, paler suckers.
glm::vec3 colour(glm::vec2 texel)
{
    const Place place = underTexel(texel);
    const float patina =
        smooth(-0.1f, 0.35f, fbm3(14.0f * place.position, 4, 331)) * smooth(0.9f, 0.1f, place.s);
    const glm::vec3 bronze =
        glm::mix(glm::vec3(0.80f, 0.46f, 0.22f), glm::vec3(0.95f, 0.70f, 0.42f), place.s);
    const glm::vec3 skin = glm::mix(bronze, glm::vec3(0.16f, 0.40f, 0.34f), 0.85f * patina);
    return glm::mix(skin, glm::vec3(0.98f, 0.80f, 0.62f), smooth(1.05f, 0.75f, suckerAt(place)));
}

void animate(GltfWriter& gltf, const std::vector<int>& joints, int arm)
{
    const float phase = kTau * float(arm) / kArms;
    for (int j = 0; j < kJoints - 1; ++j) {
        std::vector<float> seconds;
        std::vector<glm::quat> rotations;
        for (int k = 0; k <= kKeys; ++k) {
            const float turn = kTau * float(k % kKeys) / kKeys; // ends where it began
            const float t = float(j) / float(kJoints - 1);
            // The foot leans outwards, the tip curls back, and a wave runs upwards.
            const float curl =
                j == 0 ? 0.0f : -0.30f + 0.62f * t + (0.10f + 0.24f * t) * std::sin(turn + phase - 3.2f * t);
            const float sway =
                (j == 0 ? 0.0f : 0.05f + 0.15f * t) * std::sin(turn + 1.7f * phase - 2.4f * t + 1.0f);
            seconds.push_back(kSeconds * float(k) / kKeys);
            rotations.push_back(glm::angleAxis(curl, glm::vec3(1, 0, 0)) *
                                glm::angleAxis(sway, glm::vec3(0, 0, 1)));
        }
        gltf.turn(joints[size_t(j)], seconds, rotations);
    }
}

} // namespace

void writeTentacles(const std::filesystem::path& folder)
{
    GltfWriter gltf(folder, "tentacles");
    HeightMap height = makeHeight(kMap, relief);
    setSlope(height, 0.32f);
    const int bronze =
        gltf.addMaterial("bronze", {.baseColour = glm::vec3(1.0f),
                                    .metallic = 1.0f,
                                    .power = 80.0f,
                                    .colourImage = gltf.addColour("bronze", makeColour(kMap, colour)),
                                    .heightImage = gltf.addHeight("bronze", height)});
    const int stone = gltf.addMaterial("stone", {.baseColour = {0.020f, 0.026f, 0.030f}, .power = 9.0f});
    const int shape = gltf.addShape(tentacle());
    for (int i = 0; i < kArms; ++i) {
        const float angle = kTau * float(i) / kArms;
        const Placement foot{.position =
                                 glm::vec3(0.115f * std::sin(angle), -0.01f, 0.115f * std::cos(angle)),
                             .turnDegrees = 360.0f * float(i) / kArms + 180.0f,
                             .scale = 1.0f - 0.08f * float(i % 3)};
        const std::string name = "tentacle " + std::to_string(i);
        animate(gltf, gltf.addChain(name, shape, bronze, foot, kJoints, kSpacing), i);
    }
    gltf.addObject("floor", gltf.addShape(floorGrid(10.0f, 10.0f, 8)), stone);
    gltf.addCamera("default", {0.12f, 0.52f, 1.30f}, {0.0f, 0.255f, 0.0f}, 32.0f, 0.03f);
    gltf.addCamera("near", {0.30f, 0.46f, 0.62f}, {0.0f, 0.33f, 0.0f}, 36.0f, 0.02f);
    gltf.addCamera("middle", {-0.9f, 1.1f, 2.4f}, {0.0f, 0.22f, 0.0f}, 30.0f, 0.05f);
    gltf.addCamera("far", {1.6f, 2.0f, 5.2f}, {0.0f, 0.2f, 0.0f}, 24.0f, 0.1f);
    gltf.addDirectional("key", {-0.7f, 1.0f, 0.6f}, {1.0f, 0.86f, 0.68f}, 3.4f);
    gltf.addDirectional("rim", {0.9f, 0.45f, -0.5f}, {0.50f, 0.74f, 1.0f}, 3.4f);
    gltf.addDirectional("left", {-0.9f, 0.2f, -0.3f}, {1.0f, 0.62f, 0.42f}, 2.0f);
    gltf.addDirectional("fill", {0.5f, 0.35f, 0.9f}, {0.9f, 0.96f, 1.0f}, 1.6f);
    gltf.write();
}

} // namespace lumel::assets
