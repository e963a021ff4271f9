// Height maps and the pictures derived from them.
#pragma once
#include "core/image.h"
#include "core/math.h"
#include <filesystem>
#include <functional>

namespace lumel::assets {

// A height map in the form that materials use: values in [0, 1] and the height of value 1 in units of
// the map's width (material.extras.lumel.heightScale).
struct HeightMap {
    Image image; // one channel
    float scale = 0.0f;
};

// Texel centres are passed in texels from the upper left corner: (0.5, 0.5) is the first.
HeightMap makeHeight(int size, const std::function<float(glm::vec2 texel)>& height);
Image makeColour(int size, const std::function<glm::vec3(glm::vec2 texel)>& linearColour);

// Sets the scale so that the slope's root mean square over the texels where `inside` holds is
// `slopeRms`: how rough a surface looks depends on its slopes, so scenes state these.
void setSlope(
    HeightMap& map, float slopeRms,
    const std::function<bool(glm::vec2 texel)>& inside = [](glm::vec2) { return true; });

// The same surface as a glTF normal map, +x right, +y up, for viewers that do not know heights.
// Central differences, borders clamped.
Image normalFromHeight(const HeightMap& map);

// core writes PNGs of 8 bits; heights need 16 (8 would show as terraces in the normals).
void writePng(const std::filesystem::path& file, const Image& image, int bits);

} // namespace lumel::assets
