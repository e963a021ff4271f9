#include "crowd_looks.h"
#include "noise.h"
#include "pieces.h"
#include <algorithm>
#include <cmath>
#include <numbers>
#include <tbb/parallel_for.h>

namespace lumel::assets {
namespace {

constexpr float kPi = float(std::numbers::pi);
constexpr int kMap = 256;     // texels of a piece's maps
constexpr int kTileMap = 512; // texels
constexpr int kSlabs = 16;    // along a side of a tile

// A point of a piece's map: distance from its middle (1 = the foot) and turn in [0, 1).
struct Polar {
    float r, turn;
    glm::vec2 p; // in [-1, 1]
};
Polar polarOf(glm::vec2 texel)
{
    const glm::vec2 p = (texel / float(kMap) - 0.5f) / kUvRadius;
    return {glm::length(p), std::atan2(p.y, p.x) / (2.0f * kPi) + 0.5f, p};
}

float cells(glm::vec2 p, float seed) // squared distance to the nearest of scattered points, at most 1
{
    float nearest = 1.0f;
    forNeighbours({p, seed}, [&](const Scattered& point) {
        nearest = std::min(nearest, glm::dot(point.offset, point.offset));
    });
    return nearest;
}

float hammered(const Polar& at)
{
    return cells(11.0f * at.p, 0.5f);
}
float rings(const Polar& at)
{
    return std::sin(95.0f * at.r) + 0.8f * noise2({6.0f * at.turn, 60.0f * at.r}, 301, 6);
}
float flutes(const Polar& at)
{
    return std::abs(std::sin(kPi * 18.0f * at.turn)) + 0.04f * fbm3({16.0f * at.p, 0.0f}, 2, 303);
}
float beads(const Polar& at)
{
    const glm::vec2 cell = glm::fract(glm::vec2(36.0f * at.turn, 13.0f * at.r)) - 0.5f;
    return glm::max(0.0f, 1.0f - 5.0f * glm::dot(cell, cell));
}
float cast(const Polar& at)
{
    return fbm3({24.0f * at.p, 0.0f}, 3, 305);
}
float crackle(const Polar& at)
{
    return smooth(0.0f, 0.35f, std::abs(cells(9.0f * at.p, 0.25f) - 0.55f));
}
float waves(const Polar& at)
{
    return std::sin(40.0f * at.r + 4.0f * std::sin(2.0f * kPi * 5.0f * at.turn));
}
float spiral(const Polar& at)
{
    return std::abs(std::sin(kPi * (14.0f * at.turn + 9.0f * at.r)));
}

struct PieceLook {
    const char* name;
    float (*relief)(const Polar&);
    float slopeRms;
    MaterialLook look;
};
const std::array<PieceLook, kCrowdLooks> kLooks{{
    {"copper", hammered, 0.30f, {.baseColour = {0.95f, 0.50f, 0.34f}, .metallic = 1.0f, .power = 60.0f}},
    {"gold", rings, 0.26f, {.baseColour = {1.0f, 0.71f, 0.32f}, .metallic = 1.0f, .power = 90.0f}},
    {"celadon", flutes, 0.30f, {.baseColour = {0.12f, 0.34f, 0.26f}, .power = 220.0f}},
    {"cobalt", beads, 0.30f, {.baseColour = {0.02f, 0.07f, 0.34f}, .power = 260.0f}},
    {"iron", cast, 0.36f, {.baseColour = {0.26f, 0.26f, 0.28f}, .metallic = 1.0f, .power = 24.0f}},
    {"porcelain", crackle, 0.12f, {.baseColour = {0.72f, 0.70f, 0.64f}, .power = 300.0f}},
    {"silver", waves, 0.24f, {.baseColour = {0.92f, 0.92f, 0.90f}, .metallic = 1.0f, .power = 110.0f}},
    {"lacquer", spiral, 0.28f, {.baseColour = {0.42f, 0.02f, 0.015f}, .power = 240.0f}},
}};

// Wet slabs. Joints run along the tile's border, so that tiles meet as slabs do.
float slabHeight(glm::vec2 texel)
{
    const glm::vec2 p = texel * (float(kSlabs) / float(kTileMap));
    const glm::ivec2 slab = glm::ivec2(glm::floor(p));
    const glm::vec2 local = p - glm::vec2(slab) - 0.5f;
    const glm::vec2 q = 0.5f - glm::abs(local);
    const float face = smooth(0.02f, 0.09f, std::min(q.x, q.y));
    const int id = slab.y * kSlabs + slab.x;
    const float lie = 0.03f * glm::dot(glm::vec2(random01(id, 1), random01(id, 2)) - 0.5f, local);
    return face * (0.03f + lie + 0.014f * fbm3({5.0f * p, 0.0f}, 3, 311));
}

glm::vec3 slabColour(glm::vec2 texel)
{
    const glm::vec2 p = texel * (float(kSlabs) / float(kTileMap));
    const glm::ivec2 slab = glm::ivec2(glm::floor(p));
    const float tone = 0.8f + 0.4f * random01(slab.y * kSlabs + slab.x, 3);
    return tone * glm::vec3(0.060f, 0.058f, 0.064f) * (1.0f + 0.4f * fbm3({3.0f * p, 0.0f}, 3, 313));
}

} // namespace

CrowdLooks addCrowdLooks(GltfWriter& gltf)
{
    std::array<HeightMap, kLooks.size()> reliefs;
    tbb::parallel_for(size_t(0), kLooks.size(), [&](size_t i) {
        reliefs[i] = makeHeight(kMap, [&](glm::vec2 texel) { return kLooks[i].relief(polarOf(texel)); });
        setSlope(reliefs[i], kLooks[i].slopeRms, [](glm::vec2 texel) { return polarOf(texel).r < 1.0f; });
    });
    CrowdLooks crowd;
    for (size_t i = 0; i < kLooks.size(); ++i) {
        MaterialLook look = kLooks[i].look;
        look.heightImage = gltf.addHeight(kLooks[i].name, reliefs[i]);
        crowd.materials[i] = gltf.addMaterial(kLooks[i].name, look);
    }
    HeightMap slabs = makeHeight(kTileMap, slabHeight);
    setSlope(slabs, 0.16f);
    crowd.ground =
        gltf.addMaterial("slabs", {.baseColour = glm::vec3(1.0f),
                                   .power = 160.0f,
                                   .colourImage = gltf.addColour("slabs", makeColour(kTileMap, slabColour)),
                                   .heightImage = gltf.addHeight("slabs", slabs)});
    std::transform(kPieces.begin(), kPieces.end(), crowd.shapes.begin(),
                   [&](const Piece& piece) { return gltf.addShape(turnedPiece(piece.outline)); });
    return crowd;
}

} // namespace lumel::assets
