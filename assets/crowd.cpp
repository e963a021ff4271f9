// Five hundred turned pieces on a wet square at dusk, 1 to 200 m away, under sixteen lamps that each reach
// a part of it: many objects, many lights, all sizes at once.
#include "gltf_writer.h"
#include "noise.h"
#include "pieces.h"
#include "scenes.h"
#include <array>
#include <cmath>
#include <numbers>
#include <tbb/parallel_for.h>

namespace lumel::assets {
namespace {

constexpr float kPi = float(std::numbers::pi);
constexpr int kObjects = 500;
constexpr int kMap = 256;      // texels of a piece's maps
constexpr float kTile = 22.0f; // metres a side of a piece of the square
constexpr int kTileMap = 512;  // texels
constexpr int kSlabs = 16;     // a side of a tile

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
const std::array<PieceLook, 8> kLooks{{
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

// Lamps stand farther apart, higher and stronger the farther they are, so that the whole square is lit.
struct Lamp {
    glm::vec3 position;
    glm::vec3 colour;
};
std::vector<Lamp> lampPositions()
{
    const std::array<glm::vec3, 4> kColours{
        {{1.0f, 0.62f, 0.30f}, {1.0f, 0.78f, 0.52f}, {0.45f, 0.70f, 1.0f}, {1.0f, 0.42f, 0.30f}}};
    std::vector<Lamp> lamps;
    for (int i = 0; i < 16; ++i) {
        const float distance = 2.2f * std::pow(1.33f, float(i)); // metres from the first camera: 2 to 158
        const float side = (i % 2 ? 1.0f : -1.0f) * (0.12f + 0.3f * random01(i, 5));
        lamps.push_back({{side * distance, 1.2f + 0.07f * distance, -distance}, kColours[size_t(i * 7 % 4)]});
    }
    return lamps;
}

void addLamps(GltfWriter& gltf)
{
    const int globe = gltf.addShape(turnedPiece(kPieces[0].outline));
    int i = 0;
    for (const Lamp& lamp : lampPositions()) {
        const std::string name = "lamp " + std::to_string(i);
        const float height = lamp.position.y, range = 6.0f * height;
        const float candela = 5.0f * height * height; // 5 lux on the ground below
        if (i % 4 == 3)
            gltf.addSpot(name, lamp.position, {lamp.position.x * 0.6f, 0.0f, lamp.position.z - 1.5f * height},
                         lamp.colour, 3.0f * candela, 1.5f * range, 38.0f);
        else
            gltf.addPoint(name, lamp.position, lamp.colour, candela, range);
        const int glow = gltf.addMaterial(name, {.baseColour = glm::vec3(0.02f), .glow = lamp.colour});
        const float size = 0.10f * height;
        gltf.addObject(name, globe, glow,
                       {.position = lamp.position - glm::vec3(0, 0.5f * size, 0), .scale = size});
        ++i;
    }
}

// Pieces stand in a wedge before the first camera, evenly dense over the logarithm of the distance, which
// makes them evenly dense in its picture; none stands in another.
std::vector<Placement> placePieces(int count)
{
    std::vector<Placement> placed;
    for (int attempt = 0; int(placed.size()) < count; ++attempt) {
        const float distance = std::pow(200.0f, random01(attempt, 11)); // 1 to 200 m
        const float angle = glm::radians(84.0f * (random01(attempt, 12) - 0.5f));
        const float size = glm::mix(0.35f, 1.1f, random01(attempt, 13)) * (0.42f + 0.036f * distance);
        const Placement place{.position = {distance * std::sin(angle), 0.0f, -distance * std::cos(angle)},
                              .turnDegrees = 360.0f * random01(attempt, 14),
                              .scale = size};
        const bool free = std::all_of(placed.begin(), placed.end(), [&](const Placement& other) {
            return glm::distance(place.position, other.position) > 0.56f * (place.scale + other.scale);
        });
        if (free)
            placed.push_back(place);
    }
    return placed;
}

int addSquare(GltfWriter& gltf, int material)
{
    const int tile = gltf.addShape(floorGrid(kTile, kTile, 4));
    int count = 0;
    for (int z = 0; z < 10; ++z)
        for (int x = -2 * z / 3 - 3; x <= 2 * z / 3 + 3; ++x, ++count) // as wide as the cameras see
            gltf.addObject("square " + std::to_string(count), tile, material,
                           {.position = {kTile * float(x), 0.0f, -kTile * float(z)}});
    return count;
}

} // namespace

void writeCrowd(const std::filesystem::path& folder)
{
    GltfWriter gltf(folder, "crowd");
    std::array<HeightMap, kLooks.size()> reliefs;
    tbb::parallel_for(size_t(0), kLooks.size(), [&](size_t i) {
        reliefs[i] = makeHeight(kMap, [&](glm::vec2 texel) { return kLooks[i].relief(polarOf(texel)); });
        setSlope(reliefs[i], kLooks[i].slopeRms, [](glm::vec2 texel) { return polarOf(texel).r < 1.0f; });
    });
    std::array<int, kLooks.size()> materials;
    for (size_t i = 0; i < kLooks.size(); ++i) {
        MaterialLook look = kLooks[i].look;
        look.heightImage = gltf.addHeight(kLooks[i].name, reliefs[i]);
        materials[i] = gltf.addMaterial(kLooks[i].name, look);
    }
    HeightMap slabs = makeHeight(kTileMap, slabHeight);
    setSlope(slabs, 0.16f);
    const int ground =
        gltf.addMaterial("slabs", {.baseColour = glm::vec3(1.0f),
                                   .power = 160.0f,
                                   .colourImage = gltf.addColour("slabs", makeColour(kTileMap, slabColour)),
                                   .heightImage = gltf.addHeight("slabs", slabs)});
    std::array<int, kPieces.size()> shapes;
    std::transform(kPieces.begin(), kPieces.end(), shapes.begin(),
                   [&](const Piece& piece) { return gltf.addShape(turnedPiece(piece.outline)); });

    addLamps(gltf);
    const int others = 16 + addSquare(gltf, ground);
    int i = 0;
    for (const Placement& place : placePieces(kObjects - others)) {
        const auto shape = size_t(random01(i, 21) * float(kPieces.size()));
        const size_t look = (shape + (random01(i, 22) < 0.5f ? 0 : 3)) % kLooks.size(); // two a shape
        gltf.addObject(kPieces[shape].name + std::to_string(i), shapes[shape], materials[look], place);
        ++i;
    }
    gltf.addCamera("default", {0.0f, 1.7f, 1.4f}, {0.0f, 0.75f, -6.0f}, 46.0f, 0.1f);
    gltf.addCamera("near", {0.2f, 0.75f, 0.2f}, {-0.1f, 0.3f, -2.2f}, 44.0f, 0.05f);
    gltf.addCamera("far", {0.0f, 55.0f, 60.0f}, {0.0f, 0.0f, -70.0f}, 36.0f, 0.5f);
    gltf.addCamera("middle", {3.0f, 9.0f, 12.0f}, {0.0f, 0.0f, -14.0f}, 40.0f, 0.2f);
    gltf.addDirectional("moon", {0.5f, 0.7f, -0.8f}, {0.50f, 0.66f, 1.0f}, 1.0f);
    gltf.write();
}

} // namespace lumel::assets
