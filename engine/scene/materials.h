// A scene's materials, baked by the embedded baker or taken from the cache.
#pragma once
#include "half_maps.h"
#include "scene.h"

namespace lumel::scene {

struct BakedMaterial {
    Reflectance reflectance;
    // What the material adds and takes away besides reflecting: rgb = emitted radiance (linear), alpha =
    // ambient occlusion (1 open). Of a size of its own; 1 x 1 when constant.
    HalfChain emissive;
    // One channel, the share of light that the surface stops: base colour alpha of masked and blended
    // materials, mipped; 1 x 1 where it does not vary.
    HalfChain opacity;
};

struct MaterialOptions {
    baker::Method method = baker::Method::fit;
    baker::Model model = baker::Model::ashikhminShirley;
    baker::LobeCount lobes = baker::LobeCount::one; // of the method fit
    bool useCache = true;
    int threads = 0; // 0 = all cores
};

// One for each of scene.materials, with a progress line for each that is not in the cache. Throws Error
// for images that cannot be decoded and Interrupted after Ctrl-C; trouble with the cache is a warning.
std::vector<BakedMaterial> bakeMaterials(const Scene& scene, const MaterialOptions& options);

} // namespace lumel::scene
