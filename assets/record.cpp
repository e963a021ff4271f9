// A record on a turntable. Vinyl is the hardest case for the method: grooves far smaller than a
// pixel decide how the whole disc shines (the hourglass), and averaging normals loses that.
#include "gltf_writer.h"
#include "label.h"
#include "noise.h"
#include "scenes.h"
#include <array>
#include <cmath>
#include <numbers>
#include <tbb/parallel_invoke.h>

namespace lumel::assets {
namespace {

constexpr float kTau = 2.0f * float(std::numbers::pi);
constexpr float kMm = 0.001f; // metres

// Lengths in mm. A real LP has grooves 0.1 mm apart; these are 1.05 mm apart, so that a map of 2048
// texels (0.15 mm each) still has seven per groove and holds up from close by.
constexpr int kVinylMap = 2048;
constexpr float kVinylMapWidth = 306.0f;
constexpr float kVinylRadius = 150.0f;
constexpr float kHoleRadius = 3.6f;
constexpr float kPitch = 1.05f;
constexpr float kGrooveSlopeRms = 0.32f; // over the music; real groove walls stand at 45 degrees

// A side of music: where each track begins and ends (outer radius first) and how loud it is.
struct Track {
    float outer, inner, loudness;
};
constexpr std::array<Track, 5> kTracks{{{146.0f, 131.2f, 0.85f},
                                        {129.6f, 111.0f, 1.0f},
                                        {109.4f, 97.5f, 0.62f},
                                        {95.9f, 80.0f, 0.92f},
                                        {78.4f, 65.0f, 0.75f}}};
constexpr float kGapGroove = 0.3f;   // half width of a lone groove
constexpr float kRunOutPitch = 3.1f; // of the spiral after the last track
constexpr float kLockedGroove = 53.5f;

struct Polar {
    float r;    // mm
    float turn; // [0, 1), clockwise seen from above
};

Polar polarOf(glm::vec2 mm)
{
    const float turn = std::atan2(mm.y, mm.x) / kTau;
    return {glm::length(mm), turn < 0.0f ? turn + 1.0f : turn};
}

// The music: grooves along a spiral, swinging sideways as the sound does and changing in depth with it.
float trackHeight(const Track& track, Polar p)
{
    const float edge = std::min(track.outer - p.r, p.r - track.inner);
    const float swing = 0.11f * noise2({160.0f * p.turn, p.r / 1.1f}, 11, 160) +
                        0.07f * noise2({430.0f * p.turn, p.r / 0.9f}, 12, 430); // in grooves
    const float swell =
        noise2({7.0f * p.turn, p.r / 2.3f}, 13, 7) + 0.6f * noise2({23.0f * p.turn, p.r / 0.9f}, 14, 23);
    const float depth = track.loudness * (0.86f + 0.14f * swell) * smooth(0.0f, 0.5f, edge);
    return -0.5f * depth * (1.0f + std::cos(kTau * ((track.outer - p.r) / kPitch - p.turn + swing)));
}

float loneGroove(float distance) // mm from its centre line
{
    const float t = distance / kGapGroove;
    return -0.55f * std::exp(-t * t);
}

// In units of the music's depth; the scale comes from the slope.
float vinylHeight(glm::vec2 mm)
{
    const Polar p = polarOf(mm);
    if (p.r > kTracks.front().outer) // lead-in: one wide turn from the rim to the first track
        return loneGroove(p.r - (148.4f - 2.4f * p.turn)) + loneGroove(p.r - 148.4f);
    for (size_t i = 0; i < kTracks.size(); ++i) {
        const Track& track = kTracks[i];
        if (p.r >= track.inner)
            return trackHeight(track, p);
        const bool last = i + 1 == kTracks.size();
        if (!last && p.r > kTracks[i + 1].outer) // a smooth gap crossed by the groove in one turn
            return loneGroove(p.r - glm::mix(track.inner, kTracks[i + 1].outer, p.turn));
    }
    const float turns = (kTracks.back().inner - p.r) / kRunOutPitch - p.turn;
    const float spiral = (turns - std::round(turns)) * kRunOutPitch;
    return p.r > kLockedGroove + 1.2f ? loneGroove(spiral) : loneGroove(p.r - kLockedGroove);
}

glm::vec2 vinylPlace(glm::vec2 texel)
{
    return (texel / float(kVinylMap) - 0.5f) * kVinylMapWidth;
}

HeightMap makeVinyl()
{
    HeightMap map = makeHeight(kVinylMap, [](glm::vec2 texel) { return vinylHeight(vinylPlace(texel)); });
    setSlope(map, kGrooveSlopeRms, [](glm::vec2 texel) {
        const float r = glm::length(vinylPlace(texel));
        return r < kTracks.front().outer && r > kTracks.back().inner;
    });
    return map;
}

// Turned aluminium: scratches along circles, each of its own length and place, over broader waves.
HeightMap makePlatter(float mapWidthMm)
{
    constexpr int kSize = 1024;
    HeightMap map = makeHeight(kSize, [=](glm::vec2 texel) {
        const Polar p = polarOf((texel / float(kSize) - 0.5f) * mapWidthMm);
        const float texels = p.r / mapWidthMm * float(kSize);
        float height = 0.0f;
        height += 0.55f * noise2({9.0f * p.turn, texels / 2.2f}, 21, 9);
        height += 0.45f * noise2({31.0f * p.turn, texels / 3.1f}, 22, 31);
        height += 0.60f * noise2({4.0f * p.turn, texels / 7.0f}, 23, 4);
        return height;
    });
    setSlope(map, 0.22f);
    return map;
}

// Adds an arc from the angle `from` to `to` (degrees, 90 = straight up) to the profile.
void addArc(std::vector<ProfilePoint>& profile, glm::vec2 centre, float radius, float from, float to,
            int steps, float uvStart, float mapWidth)
{
    for (int i = 0; i <= steps; ++i) {
        const float angle = glm::radians(glm::mix(from, to, float(i) / float(steps)));
        const glm::vec2 normal(std::cos(angle), std::sin(angle));
        const glm::vec2 p = centre + radius * normal;
        const float length = uvStart + radius * std::abs(angle - glm::radians(from));
        profile.push_back({p.x * kMm, p.y * kMm, normal, length / mapWidth});
    }
}

// A flat disc at height y with a hole, its wall, and a rounded edge of the given radius that ends `sweep`
// degrees past the top.
Shape ringDisc(float y, float outer, float edge, float sweep, float mapWidth)
{
    std::vector<ProfilePoint> profile;
    const auto add = [&](float r, float height, glm::vec2 normal, float uv) {
        profile.push_back({r * kMm, height * kMm, normal, uv / mapWidth});
    };
    add(kHoleRadius, y - 1.5f, {-1, 0}, kHoleRadius - 1.5f);
    add(kHoleRadius, y, {-1, 0}, kHoleRadius);
    add(kHoleRadius, y, {0, 1}, kHoleRadius);
    add(0.5f * outer, y, {0, 1}, 0.5f * outer);
    addArc(profile, {outer - edge, y - edge}, edge, 90.0f, 90.0f - sweep, 10, outer - edge, mapWidth);
    return lathe(profile, 256);
}

constexpr float kPlatterTop = 18.0f, kVinylTop = kPlatterTop + 2.0f; // mm above the plinth
constexpr float kPlatterMapWidth = 364.0f, kSpindleMapWidth = 40.0f;

Shape platterShape()
{
    std::vector<ProfilePoint> profile{{0, kPlatterTop * kMm, {0, 1}, 0}};
    addArc(profile, {160, kPlatterTop - 5}, 5, 90, 0, 12, 160, kPlatterMapWidth);
    profile.push_back(
        {165 * kMm, 2 * kMm, {1, 0}, (160 + 5 * kTau / 4 + kPlatterTop - 7) / kPlatterMapWidth});
    return lathe(profile, 256);
}

Shape spindleShape()
{
    std::vector<ProfilePoint> profile{{0, (kVinylTop + 10) * kMm, {0, 1}, 0}};
    addArc(profile, {0.5f, kVinylTop + 7}, 3, 90, 0, 12, 0.5f, kSpindleMapWidth);
    profile.push_back({3.5f * kMm, kPlatterTop * kMm, {1, 0}, (0.5f + 3 * kTau / 4 + 9) / kSpindleMapWidth});
    return lathe(profile, 64);
}

void addSet(GltfWriter& gltf)
{
    const int wood = gltf.addMaterial("walnut", {.baseColour = {0.034f, 0.019f, 0.012f}, .power = 6.0f});
    const int table = gltf.addMaterial("table", {.baseColour = {0.010f, 0.018f, 0.024f}, .power = 4.0f});
    const int steel =
        gltf.addMaterial("steel", {.baseColour = {0.66f, 0.65f, 0.63f}, .metallic = 1.0f, .power = 30.0f});
    gltf.addObject("plinth", gltf.addShape(box({-0.215f, -0.07f, -0.19f}, {0.215f, 0.0f, 0.19f})), wood);
    gltf.addObject("table", gltf.addShape(floorGrid(10.0f, 10.0f, 8)), table,
                   {.position = {0.0f, -0.07f, 0.0f}});
    gltf.addObject("spindle", gltf.addShape(spindleShape()), steel);
}

void addCamerasAndLights(GltfWriter& gltf)
{
    gltf.addCamera("default", {0.10f, 0.30f, 0.40f}, {0.0f, 0.005f, 0.012f}, 38.0f, 0.02f);
    gltf.addCamera("near", {0.085f, 0.062f, 0.165f}, {0.035f, 0.020f, 0.055f}, 34.0f, 0.005f);
    gltf.addCamera("far", {0.75f, 1.75f, 2.6f}, {0.36f, -0.05f, 0.05f}, 20.0f, 0.05f);
    gltf.addCamera("middle", {0.26f, 0.62f, 0.86f}, {0.03f, 0.0f, 0.01f}, 28.0f, 0.03f);
    // From behind, so that the half vectors lean far enough over for the groove walls to catch them; two
    // azimuths make two hourglasses, warm and cool.
    gltf.addDirectional("key", {-0.55f, 1.0f, -0.62f}, {1.0f, 0.90f, 0.76f}, 5.0f);
    gltf.addDirectional("rim", {0.70f, 1.20f, -0.70f}, {0.50f, 0.72f, 1.0f}, 2.2f);
    gltf.addDirectional("fill", {0.2f, 1.0f, 0.9f}, {1.0f, 0.96f, 0.92f}, 1.3f);
}

} // namespace

void writeRecord(const std::filesystem::path& folder)
{
    GltfWriter gltf(folder, "record");
    HeightMap vinyl, platter;
    Image label;
    tbb::parallel_invoke([&] { vinyl = makeVinyl(); }, [&] { platter = makePlatter(kPlatterMapWidth); },
                         [&] { label = makeLabel(1024); });
    const int vinylLook = gltf.addMaterial("vinyl", {.baseColour = {0.012f, 0.012f, 0.013f},
                                                     .power = 120.0f,
                                                     .heightImage = gltf.addHeight("vinyl", vinyl)});
    const int platterLook =
        gltf.addMaterial("aluminium", {.baseColour = {0.50f, 0.50f, 0.51f},
                                       .metallic = 1.0f,
                                       .power = 180.0f,
                                       .heightImage = gltf.addHeight("platter", platter)});
    const int labelLook = gltf.addMaterial(
        "label",
        {.baseColour = glm::vec3(1.0f), .power = 24.0f, .colourImage = gltf.addColour("label", label)});

    gltf.addObject("record", gltf.addShape(ringDisc(kVinylTop, kVinylRadius, 1.0f, 150.0f, kVinylMapWidth)),
                   vinylLook);
    gltf.addObject("label",
                   gltf.addShape(ringDisc(kVinylTop + 0.25f, kLabelRadius, 0.25f, 90.0f, kLabelMapWidth)),
                   labelLook);
    gltf.addObject("platter", gltf.addShape(platterShape()), platterLook);
    addSet(gltf);
    addCamerasAndLights(gltf);
    gltf.write();
}

} // namespace lumel::assets
