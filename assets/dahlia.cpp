// A dahlia: two nodes with 250 instances of two petals, in the order of a sunflower's seeds. The petals'
// colours are those of their vertices.
#include "gltf_writer.h"
#include "noise.h"
#include "scenes.h"
#include <cmath>
#include <numbers>

namespace lumel::assets {
namespace {

constexpr float kTau = 2.0f * float(std::numbers::pi);
constexpr float kGoldenAngle = kTau * (2.0f - float(std::numbers::phi));
constexpr int kMap = 256; // texels
constexpr int kOuter = 150, kInner = 100;

// A petal of length 1 along +Y from its foot, its inner side towards +Z: x in [-1, 1] across, y in [0, 1]
// along. `cup`: how much its sides curve inwards.
glm::vec3 petalAt(glm::vec2 p, float cup)
{
    const float width = 0.25f * std::pow(std::sin(0.5f * kTau * std::pow(0.04f + 0.95f * p.y, 1.25f)), 0.75f);
    const float bow = 0.17f * p.y * p.y - 0.10f * std::sin(0.5f * kTau * p.y); // outwards, then up
    return {width * p.x * (1.0f - 0.2f * cup * p.x * p.x), p.y, bow + cup * width * p.x * p.x};
}

Shape petal(float cup, glm::vec3 foot, glm::vec3 middle, glm::vec3 edge)
{
    constexpr int kAcross = 10, kAlong = 16;
    Shape shape;
    for (int j = 0; j <= kAlong; ++j)
        for (int i = 0; i <= kAcross; ++i) {
            const glm::vec2 t(float(i) / kAcross, float(j) / kAlong), p(2.0f * t.x - 1.0f, t.y);
            constexpr float kStep = 1e-3f;
            const auto along = [&](glm::vec2 d) {
                const glm::vec2 low = glm::max(p - kStep * d, glm::vec2(-1.0f, 0.0f)),
                                high = glm::min(p + kStep * d, glm::vec2(1.0f));
                return petalAt(high, cup) - petalAt(low, cup);
            };
            const glm::vec3 u = along({1, 0}), up = along({0, 1});
            const glm::vec3 normal = glm::normalize(glm::cross(u, up));
            shape.add(petalAt(p, cup), normal, tangentOf(u, up, normal),
                      {glm::mix(0.02f, 0.98f, t.x), glm::mix(0.98f, 0.02f, t.y)});
            const float rim = std::max(smooth(0.5f, 1.0f, std::abs(p.x)), smooth(0.82f, 1.0f, p.y));
            shape.colours.push_back(glm::mix(glm::mix(foot, middle, smooth(0.0f, 0.75f, p.y)), edge, rim));
        }
    const uint32_t row = kAcross + 1;
    for (uint32_t j = 0; j < kAlong; ++j)
        for (uint32_t i = 0; i < kAcross; ++i)
            shape.quad(j * row + i, j * row + i + 1, (j + 1) * row + i + 1, (j + 1) * row + i);
    return shape;
}

// Veins that run along the petal and fan out, and the fine grain of its skin.
float relief(glm::vec2 texel)
{
    const glm::vec2 t = texel / float(kMap);
    const float across = (t.x - 0.5f) * (1.0f + 0.5f * t.y);
    const float wave = std::cos(kTau * (9.0f * across + 0.12f * noise2({3.0f * t.x, 4.0f * t.y}, 511)));
    return 0.5f * std::pow(0.5f + 0.5f * wave, 2.0f) - std::exp(-900.0f * (t.x - 0.5f) * (t.x - 0.5f)) +
           0.09f * noise2(70.0f * t, 517);
}

// Petal i of all, from the middle outwards: upright first, then open, finally turned down.
Instance placed(int i)
{
    const float share = std::sqrt((float(i) + 0.5f) / float(kInner + kOuter));
    const float angle = kGoldenAngle * float(i), open = glm::mix(0.08f, 1.50f, std::pow(share, 0.9f));
    const float jitter = 0.12f * (random01(i, 71) - 0.5f);
    const glm::quat turn = glm::angleAxis(angle + jitter, glm::vec3(0, 1, 0));
    // Its inner side faces the middle: +Z of the petal is -Z of the flower's spoke.
    const glm::quat lean = glm::angleAxis(-(open + jitter), glm::vec3(1, 0, 0));
    const glm::vec3 foot = turn * glm::vec3(0.0f, 0.030f * (1.0f - share * share), -0.034f * share);
    return {foot, turn * lean, glm::mix(0.030f, 0.088f, std::pow(share, 0.8f))};
}

} // namespace

void writeDahlia(const std::filesystem::path& folder)
{
    GltfWriter gltf(folder, "dahlia");
    HeightMap height = makeHeight(kMap, relief);
    setSlope(height, 0.16f);
    const int skin = gltf.addMaterial("petal", {.baseColour = glm::vec3(1.0f),
                                                .power = 28.0f,
                                                .heightImage = gltf.addHeight("petal", height),
                                                .doubleSided = true});
    std::vector<Instance> inner, outer;
    for (int i = 0; i < kInner + kOuter; ++i)
        (i < kInner ? inner : outer).push_back(placed(i));
    gltf.addInstances(
        "inner petals",
        gltf.addShape(petal(1.0f, {0.50f, 0.05f, 0.02f}, {0.86f, 0.16f, 0.06f}, {1.0f, 0.62f, 0.20f})), skin,
        inner);
    gltf.addInstances(
        "outer petals",
        gltf.addShape(petal(0.55f, {0.34f, 0.01f, 0.05f}, {0.72f, 0.03f, 0.10f}, {0.98f, 0.50f, 0.42f})),
        skin, outer);
    const int ground = gltf.addMaterial("ground", {.baseColour = {0.018f, 0.022f, 0.024f}, .power = 60.0f});
    gltf.addObject("ground", gltf.addShape(floorGrid(3.0f, 3.0f, 6)), ground,
                   {.position = {0.0f, -0.045f, 0.0f}});
    gltf.addCamera("default", {0.06f, 0.24f, 0.26f}, {0.0f, 0.0f, 0.0f}, 34.0f, 0.01f);
    gltf.addCamera("near", {0.02f, 0.14f, 0.11f}, {0.0f, 0.02f, 0.0f}, 36.0f, 0.005f);
    gltf.addCamera("middle", {0.22f, 0.34f, 0.50f}, {0.0f, 0.0f, 0.0f}, 30.0f, 0.02f);
    gltf.addCamera("far", {0.4f, 0.7f, 1.3f}, {0.0f, 0.0f, 0.0f}, 24.0f, 0.05f);
    gltf.addDirectional("key", {-0.6f, 1.0f, 0.5f}, {1.0f, 0.94f, 0.84f}, 3.0f);
    gltf.addDirectional("rim", {0.8f, 0.35f, -0.7f}, {0.70f, 0.82f, 1.0f}, 2.4f);
    gltf.addDirectional("fill", {0.5f, 0.4f, 0.9f}, {1.0f, 0.92f, 0.92f}, 0.9f);
    gltf.write();
}

} // namespace lumel::assets
