// A copper mould, a spun lid, brass weights and a scratched tray: reliefs whose normals stand in two groups
// or along two lines, which one lobe cannot hold.
#include "gltf_writer.h"
#include "noise.h"
#include "pieces.h"
#include "scenes.h"
#include <array>
#include <cmath>
#include <numbers>
#include <tbb/parallel_invoke.h>

namespace lumel::assets {
namespace {

constexpr float kTau = 2.0f * float(std::numbers::pi);

// A point of a turned piece's map of `size` texels. Heights below are in texels, so that slopes need no
// scale.
struct Polar {
    float r;    // texels from the middle
    float turn; // [0, 1)
};
Polar polarOf(glm::vec2 texel, int size)
{
    const glm::vec2 p = texel - 0.5f * float(size);
    return {glm::length(p), std::atan2(p.y, p.x) / kTau + 0.5f};
}

HeightMap makeRelief(int size, float (*texels)(glm::vec2))
{
    return makeHeight(size, [=](glm::vec2 texel) { return texels(texel) / float(size); });
}

// A V-groove of slope 1 and period `width`, highest where t is whole.
float groove(float t, float width)
{
    return -width * std::abs(t - std::round(t));
}

// Two tiers of flutes down the sides of a mould, twice as many in the lower one: 9 texels wide or more.
constexpr int kMouldMap = 1024;
float flutes(glm::vec2 texel)
{
    const Polar at = polarOf(texel, kMouldMap);
    const float r = at.r / float(kMouldMap) / kUvRadius;
    const float count = r < 0.61f ? 100.0f : 200.0f;
    const float tiers =
        smooth(0.29f, 0.31f, r) * smooth(0.60f, 0.58f, r) + smooth(0.62f, 0.64f, r) * smooth(0.92f, 0.90f, r);
    const float wear = 0.92f + 0.08f * noise2({9.0f * at.turn, at.r / 60.0f}, 601, 9);
    return 0.30f * wear * tiers * groove(count * at.turn, kTau * at.r / count) +
           0.04f * noise2({40.0f * at.turn, at.r / 5.0f}, 603, 40);
}

// Rings cut by a pointed tool, deeper towards the rim.
constexpr int kWeightMap = 1024;
float rings(glm::vec2 texel)
{
    const Polar at = polarOf(texel, kWeightMap);
    constexpr float kWidth = 10.0f;
    const float r = at.r / float(kWeightMap) / kUvRadius;
    return 0.26f * smooth(0.0f, 0.1f, r) * groove(at.r / kWidth, kWidth) +
           0.04f * noise2({30.0f * at.turn, at.r / 2.5f}, 607, 30);
}

// Brushed on a lathe: strokes along circles, each of its own length and depth, few of them deep.
constexpr int kLidMap = 1024;
float spun(glm::vec2 texel)
{
    const Polar at = polarOf(texel, kLidMap);
    float height = 0.0f;
    for (int i = 0; i < 3; ++i) {
        const int period = 5 + 9 * i;
        const float stroke =
            noise2({float(period) * at.turn, at.r / (2.6f + 1.7f * float(i))}, 611 + i, period);
        height += stroke * std::abs(stroke) * (1.0f + 0.5f * float(i));
    }
    return 0.9f * height;
}

// One direction of a scoured tray: lanes side by side, cut into strokes of random ends and depths.
float strokes(glm::vec2 p, float width, int seed)
{
    const float lane = std::floor(p.x / width);
    const float length = width * (14.0f + 22.0f * random01(int(lane), 1, seed));
    const float along = p.y / length + random01(int(lane), 2, seed);
    const int id =
        int(hash(uint32_t(int(lane)) + hash(uint32_t(int(std::floor(along))) + uint32_t(seed))) >> 8);
    const float ends = smooth(0.0f, 0.12f, std::min(along - std::floor(along), std::ceil(along) - along));
    const float depth = ends * (0.25f + 0.75f * random01(id, 3));
    const float t = 2.0f * (p.x / width - lane) - 1.0f;
    return -0.5f * width * depth * (1.0f - t * t) * (1.0f - t * t);
}

// The deeper of two crossing strokes is seen.
constexpr int kTrayMap = 2048;
float scoured(glm::vec2 texel)
{
    float deepest = 0.0f;
    for (int i = 0; i < 2; ++i) {
        const float angle = glm::radians(i == 0 ? -30.0f : 38.0f);
        const glm::vec2 across(std::cos(angle), std::sin(angle)), along(-across.y, across.x);
        const glm::vec2 p(glm::dot(texel, across), glm::dot(texel, along));
        deepest = std::min(deepest, 0.30f * strokes(p, 7.0f, 631 + i));
    }
    return deepest + 0.02f * noise2(texel / 3.0f, 641);
}

// Oak, stained: streaks along x, boards 0.14 m wide, a joint between two.
constexpr float kTable = 2.4f; // metres, side length
glm::vec3 oak(glm::vec2 texel)
{
    const glm::vec2 p = texel / 1024.0f * kTable;
    const float board = std::floor(p.y / 0.14f), within = p.y / 0.14f - board;
    const glm::vec2 q(p.x + 7.3f * board, p.y);
    const float warp = 0.02f * noise2(3.0f * q, 651);
    const float streaks = noise2({2.5f * q.x, 70.0f * (q.y + warp)}, 653) +
                          0.6f * noise2({6.0f * q.x, 190.0f * (q.y + warp)}, 655);
    const float joint = smooth(0.0f, 0.02f, std::min(within, 1.0f - within));
    const float tone = 0.8f + 0.4f * random01(int(board), 657);
    return joint * tone * (1.0f + 0.35f * streaks) * glm::vec3(0.060f, 0.034f, 0.020f);
}

// Outlines in metres, from the axis on top outwards and down.
const Outline kMould{{0, 0.074f},          {0.01516f, 0.07273f}, {0.0278f, 0.06898f},  {0.03889f, 0.06288f},
                     {0.04831f, 0.05467f}, {0.0559f, 0.04467f},  {0.06146f, 0.03326f}, {0.06486f, 0.02088f},
                     {0.066f, 0.008f},     {0.067f, 0.004f},     {0.074f, 0.003f},     {0.077f, 0.0015f},
                     {0.077f, 0}};
const Outline kLid{{0, 0.020f},        {0.03f, 0.0195f}, {0.06f, 0.018f},  {0.09f, 0.0145f}, {0.108f, 0.010f},
                   {0.1155f, 0.0065f}, {0.119f, 0.005f}, {0.125f, 0.005f}, {0.127f, 0.003f}, {0.126f, 0.0f}};
const Outline kKnob{{0, 0.030f},      {0.010f, 0.029f}, {0.016f, 0.025f}, {0.0165f, 0.020f},
                    {0.012f, 0.014f}, {0.007f, 0.009f}, {0.008f, 0.003f}, {0.012f, 0}};
const Outline kWeight{{0, 0.0352f},      {0.010f, 0.0352f}, {0.020f, 0.0352f},
                      {0.0285f, 0.035f}, {0.030f, 0.0335f}, {0.0302f, 0.031f},
                      {0.0302f, 0.016f}, {0.0302f, 0.002f}, {0.029f, 0}};
const Outline kTray{{0, 0.004f},       {0.07f, 0.004f},   {0.14f, 0.004f},
                    {0.186f, 0.0042f}, {0.196f, 0.007f},  {0.203f, 0.0135f},
                    {0.210f, 0.016f},  {0.214f, 0.0145f}, {0.213f, 0.011f}};

struct Reliefs {
    HeightMap mould, weight, lid, tray;
    Image oak;
};

void addMetals(GltfWriter& gltf, const Reliefs& reliefs)
{
    const auto metal = [&](const char* name, glm::vec3 colour, float power, const HeightMap& relief) {
        return gltf.addMaterial(name, {.baseColour = colour,
                                       .metallic = 1.0f,
                                       .power = power,
                                       .heightImage = gltf.addHeight(name, relief)});
    };
    const int copper = metal("copper", {0.93f, 0.52f, 0.36f}, 260.0f, reliefs.mould);
    const int brass = metal("brass", {0.88f, 0.66f, 0.30f}, 300.0f, reliefs.weight);
    const int aluminium = metal("aluminium", {0.80f, 0.81f, 0.82f}, 200.0f, reliefs.lid);
    const int steel = metal("steel", {0.56f, 0.57f, 0.58f}, 300.0f, reliefs.tray);

    gltf.addObject("tray", gltf.addShape(turnedPiece(kTray, 4, 160)), steel);
    gltf.addObject("mould", gltf.addShape(turnedPiece(kMould, 4, 144)), copper,
                   {.position = {-0.085f, 0.004f, -0.055f}});
    const glm::vec3 lid(0.30f, 0.0f, -0.10f);
    gltf.addObject("lid", gltf.addShape(turnedPiece(kLid, 4, 160)), aluminium, {.position = lid});
    gltf.addObject("knob", gltf.addShape(turnedPiece(kKnob, 4, 64)), brass,
                   {.position = lid + glm::vec3(0.0f, 0.0195f, 0.0f)});
    const int weight = gltf.addShape(turnedPiece(kWeight, 4, 96));
    const std::array<Placement, 4> weights{{{{0.065f, 0.004f, 0.02f}, 20.0f, 1.25f},
                                            {{-0.26f, 0.0f, 0.08f}, 70.0f, 1.0f},
                                            {{-0.20f, 0.0f, 0.165f}, 0.0f, 0.74f},
                                            {{0.235f, 0.0f, 0.125f}, 130.0f, 0.9f}}};
    for (const Placement& place : weights)
        gltf.addObject("weight", weight, brass, place);
}

} // namespace

void writeGrooves(const std::filesystem::path& folder)
{
    GltfWriter gltf(folder, "grooves");
    Reliefs reliefs;
    tbb::parallel_invoke([&] { reliefs.mould = makeRelief(kMouldMap, flutes); },
                         [&] { reliefs.weight = makeRelief(kWeightMap, rings); },
                         [&] { reliefs.lid = makeRelief(kLidMap, spun); },
                         [&] { reliefs.tray = makeRelief(kTrayMap, scoured); },
                         [&] { reliefs.oak = makeColour(1024, oak); });
    addMetals(gltf, reliefs);
    const int table = gltf.addMaterial(
        "oak",
        {.baseColour = glm::vec3(1.0f), .power = 14.0f, .colourImage = gltf.addColour("oak", reliefs.oak)});
    gltf.addObject("table", gltf.addShape(floorGrid(kTable, kTable, 8)), table);

    gltf.addCamera("default", {0.10f, 0.40f, 0.72f}, {0.03f, 0.01f, 0.01f}, 34.0f, 0.02f);
    gltf.addCamera("near", {0.050f, 0.095f, 0.150f}, {0.004f, 0.032f, -0.012f}, 42.0f, 0.005f);
    gltf.addCamera("middle", {0.22f, 0.62f, 1.05f}, {0.03f, 0.0f, 0.01f}, 32.0f, 0.03f);
    gltf.addCamera("far", {0.72f, 1.66f, 2.90f}, {0.03f, 0.0f, 0.01f}, 18.0f, 0.05f);
    // A lamp over the table, a low sun from the left, and sky.
    gltf.addPoint("lamp", {0.02f, 0.50f, -0.45f}, {1.0f, 0.82f, 0.58f}, 0.42f, 0.0f);
    gltf.addDirectional("sun", {-0.9f, 0.42f, 0.10f}, {1.0f, 0.88f, 0.70f}, 3.0f);
    gltf.addDirectional("sky", {0.7f, 0.8f, -0.35f}, {0.62f, 0.78f, 1.0f}, 1.2f);
    gltf.write();
}

} // namespace lumel::assets
