// Five hundred turned pieces on a wet square at dusk, 1 to 200 m away, under sixteen lamps that each reach
// a part of it: many objects, many lights, all sizes at once.
#include "crowd_looks.h"
#include "noise.h"
#include "scenes.h"
#include <algorithm>
#include <array>
#include <cmath>

namespace lumel::assets {
namespace {

constexpr int kObjects = 500;
constexpr float kTile = 22.0f; // metres, side of one tile of the square

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
        const int emissive =
            gltf.addMaterial(name, {.baseColour = glm::vec3(0.02f), .emissive = lamp.colour});
        const float size = 0.10f * height;
        gltf.addObject(name, globe, emissive,
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
    const CrowdLooks crowd = addCrowdLooks(gltf);
    addLamps(gltf);
    const int others = 16 + addSquare(gltf, crowd.ground);
    int i = 0;
    for (const Placement& place : placePieces(kObjects - others)) {
        const auto shape = size_t(random01(i, 21) * float(kPieces.size()));
        const size_t look = (shape + (random01(i, 22) < 0.5f ? 0 : 3)) % kCrowdLooks; // two per shape
        gltf.addObject(kPieces[shape].name + std::to_string(i), crowd.shapes[shape], crowd.materials[look],
                       place);
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
