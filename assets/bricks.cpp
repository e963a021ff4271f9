// A brick floor that runs to the horizon: one surface that needs every MIP level at once.
#include "brick.h"
#include "gltf_writer.h"
#include "scenes.h"
#include <cmath>
#include <tbb/parallel_invoke.h>

namespace lumel::assets {
namespace {

constexpr int kMap = 2048;      // texels
constexpr float kFloor = 24.0f; // metres, side length
constexpr float kBrick = 0.2f;  // metres, the brick's short side: 17 texels
constexpr float kSlopeRms = 0.30f;

// Running bond: bricks twice as long as wide, every other row moved by half.
BrickPlace placeOf(glm::vec2 p) // in brick heights
{
    const int row = int(std::floor(p.y));
    const float shifted = p.x + (row % 2 == 0 ? 0.0f : 1.0f);
    const int column = int(std::floor(0.5f * shifted));
    const glm::vec2 centre(2.0f * float(column) + 1.0f, float(row) + 0.5f);
    return {glm::vec2(shifted, p.y) - centre, {1.0f, 0.5f}, column + 1000 * row};
}

glm::vec2 bricksAt(glm::vec2 texel)
{
    return texel / float(kMap) * (kFloor / kBrick);
}

} // namespace

void writeBricks(const std::filesystem::path& folder)
{
    GltfWriter gltf(folder, "bricks");
    HeightMap height;
    Image colour;
    tbb::parallel_invoke(
        [&] {
            height = makeHeight(kMap, [](glm::vec2 texel) {
                const glm::vec2 p = bricksAt(texel);
                const float sag = 0.25f * fbm3({0.06f * p, 0.0f}, 3, 53); // the ground under the bricks
                return brickHeight(placeOf(p), {p, 0.0f}) + sag;
            });
            setSlope(height, kSlopeRms);
        },
        [&] {
            colour = makeColour(kMap, [](glm::vec2 texel) {
                const glm::vec2 p = bricksAt(texel);
                return brickColour(placeOf(p), {p, 0.0f});
            });
        });
    const int bricks = gltf.addMaterial("bricks", {.baseColour = glm::vec3(1.0f),
                                                   .power = 120.0f, // wet after rain
                                                   .colourImage = gltf.addColour("bricks", colour),
                                                   .heightImage = gltf.addHeight("bricks", height)});
    gltf.addObject("floor", gltf.addShape(floorGrid(kFloor, kFloor, 64)), bricks);

    gltf.addCamera("default", {0.0f, 1.65f, 11.0f}, {0.0f, 1.0f, 5.0f}, 34.0f, 0.05f); // standing height
    gltf.addCamera("near", {0.3f, 0.55f, 1.0f}, {0.1f, 0.0f, 0.0f}, 45.0f, 0.02f);
    gltf.addCamera("far", {9.0f, 14.0f, 26.0f}, {0.0f, 0.0f, 0.0f}, 40.0f, 0.1f);
    gltf.addCamera("middle", {2.5f, 2.6f, 11.5f}, {0.5f, 0.0f, 2.0f}, 40.0f, 0.05f);
    gltf.addDirectional("low sun", {0.25f, 0.42f, -1.0f}, {1.0f, 0.80f, 0.58f}, 2.0f);
    gltf.addDirectional("sky", {-0.6f, 1.0f, 0.5f}, {0.55f, 0.70f, 1.0f}, 1.4f);
    gltf.write();
}

} // namespace lumel::assets
