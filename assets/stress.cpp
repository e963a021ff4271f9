// A thousand instances in the order of a sunflower's seeds, lit by 64 lanterns that drift among them, and a
// camera that flies a figure of eight through the middle: everything that costs time, at all distances, in
// motion. The default scene of `lumel bench`.
#include "crowd_looks.h"
#include "noise.h"
#include "scenes.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace lumel::assets {
namespace {

constexpr float kPi = float(std::numbers::pi);
constexpr float kGoldenAngle = 2.0f * kPi * (2.0f - float(std::numbers::phi)); // radians from seed to seed
constexpr int kObjects = 1000;
constexpr int kLamps = 64;
constexpr float kSeconds = 20.0f; // one round of the camera and the lanterns
constexpr float kRadius = 72.0f;  // metres, of all pieces
constexpr float kTile = 13.0f;    // metres, side of one tile of the ground
// Levels of detail by metres from the camera's path: their error is about one pixel there, at 960x540.
struct Lod {
    float farthest;
    int steps, segments; // of turnedPiece()
};
constexpr std::array<Lod, 5> kLods{
    {{2.0f, 3, 40}, {5.0f, 2, 24}, {10.0f, 1, 18}, {30.0f, 1, 14}, {1e9f, 1, 10}}};
constexpr float kClearance = 0.8f; // metres free on both sides of the camera's path

// A seed of a sunflower, nearer together in the middle: its place, and the distance to its neighbours.
struct Seed {
    glm::vec3 place;
    float spacing;
};
Seed seedOf(int i, int count, float turn)
{
    constexpr float kSpread = 0.9f; // 0.5: as dense everywhere
    const float share = (float(i) + 0.5f) / float(count), angle = turn + kGoldenAngle * float(i);
    const float r = kRadius * std::pow(share, kSpread);
    const float area = 2.0f * kPi * kSpread * r * r / (share * float(count)); // of the ring of one seed
    return {{r * std::sin(angle), 0.0f, r * std::cos(angle)}, std::sqrt(area)};
}

// The camera's path and target: turns 0 to 1 are one round.
glm::vec3 wayAt(float turn)
{
    const float angle = 2.0f * kPi * turn;
    return {19.0f * std::sin(angle), 2.1f - 0.9f * std::cos(2.0f * angle), 10.0f * std::sin(2.0f * angle)};
}
glm::vec3 gazeAt(float turn)
{
    const glm::vec3 ahead = wayAt(turn + 0.09f);
    return {0.86f * ahead.x, 0.25f * wayAt(turn).y, 0.86f * ahead.z};
}

float distanceToWay(glm::vec3 place)
{
    float nearest = 1e9f;
    for (int i = 0; i < 400; ++i) {
        const glm::vec3 way = wayAt(float(i) / 400.0f);
        nearest = std::min(nearest, glm::distance(glm::vec2(way.x, way.z), glm::vec2(place.x, place.z)));
    }
    return nearest;
}

// Keys of a spline through a closed curve over one round.
struct Keys {
    std::vector<float> seconds;
    std::vector<glm::vec3> places, tangents;
};
template<class Curve>
Keys closedCurve(int count, const Curve& placeAt)
{
    constexpr float kStep = 1e-3f; // turns
    Keys keys;
    for (int i = 0; i <= count; ++i) {
        const float turn = float(i % count) / float(count); // ends exactly where it began
        keys.seconds.push_back(kSeconds * float(i) / float(count));
        keys.places.push_back(placeAt(turn));
        keys.tangents.push_back((placeAt(turn + kStep) - placeAt(turn - kStep)) / (2.0f * kStep * kSeconds));
    }
    return keys;
}

void addCamera(GltfWriter& gltf)
{
    const int camera = gltf.addCamera("default", wayAt(0.0f), gazeAt(0.0f), 50.0f, 0.1f);
    const Keys keys = closedCurve(32, wayAt);
    gltf.move({camera}, keys.seconds, keys.places, keys.tangents);
    std::vector<float> seconds;
    std::vector<glm::quat> rotations;
    constexpr int kTurns = 160;
    for (int i = 0; i <= kTurns; ++i) {
        const float turn = float(i % kTurns) / kTurns;
        seconds.push_back(kSeconds * float(i) / kTurns);
        rotations.push_back(glm::quatLookAt(glm::normalize(gazeAt(turn) - wayAt(turn)), glm::vec3(0, 1, 0)));
    }
    gltf.turn(camera, seconds, rotations);
}

// Fire and dusk, a Fibonacci number of colours: lanterns of one colour stand along an arm.
const std::array<glm::vec3, 8> kLampColours{{{1.0f, 0.56f, 0.24f},
                                             {0.36f, 0.60f, 1.0f},
                                             {1.0f, 0.74f, 0.44f},
                                             {1.0f, 0.36f, 0.30f},
                                             {0.40f, 0.86f, 0.92f},
                                             {1.0f, 0.64f, 0.30f},
                                             {0.66f, 0.46f, 1.0f},
                                             {1.0f, 0.82f, 0.58f}}};

void addLamps(GltfWriter& gltf, int globe)
{
    std::vector<int> lanterns;
    for (size_t i = 0; i < kLampColours.size(); ++i)
        lanterns.push_back(gltf.addMaterial("lantern " + std::to_string(i),
                                            {.baseColour = glm::vec3(0.02f), .emissive = kLampColours[i]}));
    for (int i = 0; i < kLamps; ++i) {
        const Seed seed = seedOf(i, kLamps, 1.0f);
        const float distance = glm::length(seed.place), height = 1.5f + 0.045f * distance;
        const float around = 0.22f * seed.spacing, way = i % 2 == 0 ? 1.0f : -1.0f;
        const float phase = 2.0f * kPi * random01(i, 31);
        const auto placeAt = [&](float turn) {
            const float angle = phase + way * 2.0f * kPi * turn;
            return seed.place + glm::vec3(around * std::sin(angle),
                                          height * (1.0f + 0.15f * std::sin(2.0f * angle + phase)),
                                          around * std::cos(angle));
        };
        const size_t colour = size_t(i) % kLampColours.size();
        const float candela = 11.0f * height * height; // 11 lux on the ground below
        const std::string name = "lantern " + std::to_string(i);
        const Keys keys = closedCurve(12, placeAt);
        const int light = gltf.addPoint(name, keys.places[0], kLampColours[colour], candela, 4.5f * height);
        const int emissive = gltf.addObject(name, globe, lanterns[colour],
                                            {.position = keys.places[0], .scale = 0.11f * height});
        gltf.move({light, emissive}, keys.seconds, keys.places, keys.tangents);
    }
}

int addGround(GltfWriter& gltf, int material)
{
    const int tile = gltf.addShape(floorGrid(kTile, kTile, 4));
    int count = 0;
    for (int z = -6; z <= 6; ++z)
        for (int x = -6; x <= 6; ++x)
            if (x * x + z * z <= 39)
                gltf.addObject("ground " + std::to_string(count++), tile, material,
                               {.position = {kTile * float(x), 0.0f, kTile * float(z)}});
    return count;
}

} // namespace

void writeStress(const std::filesystem::path& folder)
{
    GltfWriter gltf(folder, "stress");
    const CrowdLooks crowd = addCrowdLooks(gltf);
    const int pieces = kObjects - kLamps - addGround(gltf, crowd.ground);
    addLamps(gltf, gltf.addShape(turnedPiece(kPieces[0].outline, 1, 14)));
    std::array<std::array<int, kPieceCount>, kLods.size()> shapes{crowd.shapes};
    for (size_t lod = 1; lod < kLods.size(); ++lod)
        for (size_t i = 0; i < kPieceCount; ++i)
            shapes[lod][i] =
                gltf.addShape(turnedPiece(kPieces[i].outline, kLods[lod].steps, kLods[lod].segments));
    int placed = 0;
    for (int i = 0; placed < pieces; ++i) {
        const Seed seed = seedOf(i, pieces, 0.0f);
        const float size = glm::mix(0.46f, 0.66f, random01(i, 41)) * seed.spacing;
        const float distance = distanceToWay(seed.place);
        if (distance < kClearance + 0.5f * size)
            continue;
        const size_t look = size_t(i) % kCrowdLooks; // a Fibonacci number: arms of one material
        const size_t shape = (look + size_t(i / 55)) % kPieceCount;
        const auto lod = size_t(
            std::ranges::find_if(kLods, [&](const Lod& l) { return distance < l.farthest; }) - kLods.begin());
        gltf.addObject(kPieces[shape].name + std::to_string(i), shapes[lod][shape], crowd.materials[look],
                       {.position = seed.place, .turnDegrees = 360.0f * random01(i, 42), .scale = size});
        ++placed;
    }
    addCamera(gltf);
    gltf.addCamera("near", {2.6f, 1.0f, 4.4f}, {1.0f, 0.5f, 0.5f}, 46.0f, 0.05f);
    gltf.addCamera("middle", {6.0f, 7.0f, 20.0f}, {0.0f, 0.0f, -4.0f}, 46.0f, 0.2f);
    gltf.addCamera("far", {0.0f, 27.0f, 46.0f}, {0.0f, 0.0f, 3.0f}, 46.0f, 0.5f);
    gltf.addDirectional("moon", {0.5f, 0.7f, -0.8f}, {0.50f, 0.66f, 1.0f}, 1.0f);
    gltf.write();
}

} // namespace lumel::assets
