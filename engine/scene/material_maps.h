// glTF's metallic-roughness material to what the baker takes.
#pragma once
#include "baker/bake.h"
#include "scene.h"

namespace lumel::scene {

// Decodes the images that reflection depends on. Constant materials give a map of 1 x 1 texels.
baker::Maps reflectanceMaps(const Scene& scene, const Material& material);

// Whether glow varies over the surface, told without decoding.
bool glowVaries(const Material& material);
// Emitted radiance (rgb) and ambient occlusion (alpha); 1 x 1 when it does not vary.
Image glowImage(const Scene& scene, const Material& material);

// Base colour alpha, one channel; 1 x 1 when opaque or without an image that has alpha.
Image opacityImage(const Scene& scene, const Material& material);

// The image and its halves down to 1 x 1: level L is max(1, floor(size / 2^L)), each texel the average
// of the area that it covers.
std::vector<Image> mipChain(Image image);

// The mean of level 0's Ks under each texel, three channels; 1 x 1 where it does not vary. A fitted Ks is the
// projection of the mean reflectance on one lobe, which reflects less in all than that does.
std::vector<Image> meanSpecular(const baker::ReflectanceMips& mips);

} // namespace lumel::scene
