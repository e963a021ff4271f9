// glTF's metallic-roughness material to what the baker takes.
#pragma once
#include "baker/bake.h"
#include "half_maps.h"
#include "scene.h"

namespace lumel::scene {

// Decodes the images that reflection depends on. Constant materials give a map of 1 x 1 texels.
baker::Maps reflectanceMaps(const Scene& scene, const Material& material);

// Whether emission varies over the surface, told without decoding.
bool emissiveVaries(const Material& material);
// Emitted radiance (rgb) and ambient occlusion (alpha); 1 x 1 when it does not vary.
Image emissiveImage(const Scene& scene, const Material& material);

// Base colour alpha, one channel; 1 x 1 when opaque or without an image that has alpha.
Image opacityImage(const Scene& scene, const Material& material);

// The image and its halves down to 1 x 1: level L is max(1, floor(size / 2^L)), each texel the average
// of the area that it covers.
std::vector<Image> mipChain(Image image);
// The same of an emissive image in half floats, averaged from what its level 0 rounds to.
HalfChain emissiveChain(Image image);

// What the level-0 lobes under each texel are on average: F0 (rgb) and their variance (alpha), see
// shaders/shared/energy.h; 1 x 1 where neither varies. A fitted Ks is the projection of the mean reflectance
// on one lobe, which reflects less in all than that does, and a fitted S holds the spread of normals too.
std::vector<Image> baseReflectance(const baker::ReflectanceMips& mips);

} // namespace lumel::scene
