// A baked chain for engines whose lobe is GGX: each level refitted to the average of level 0.
//
// Level 0 holds the surface's own lobes. Each becomes the GGX lobe that looks alike (the inverse of
// powerFromRoughness, energy.h), so that the roughness that was baked comes back. A coarser texel gets the
// GGX lobe nearest to the exact average of these, sum(F0 D) / n, in the least-squares sense over the disc of
// half vectors. Its normal is the baked one, its F0 the mean F0: what it reflects in all stays right.
#pragma once
#include "baker/bake.h"
#include "ggx_lobe.h"

namespace lumel::baker {

struct GgxTexel {
    GgxShape shape; // alphaT is the greater one
    glm::vec3 f0{0.0f};
    glm::vec3 diffuse{0.0f};
};

// Relative squared errors over the disc of half vectors, of the luminance of F0 D.
struct GgxErrors {
    double mean = 0.0, worst = 0.0; // of what is exported
    double converted = 0.0;         // mean, with alpha^2 = 2 / (power + 2) of the baked lobe
    double averaged = 0.0;          // mean, with averaged normals and roughness: an engine's own MIPs
};

struct GgxLevel {
    int width = 0, height = 0;
    std::vector<GgxTexel> texels;
    GgxErrors errors;
    const GgxTexel& at(int x, int y) const { return texels[size_t(y) * size_t(width) + size_t(x)]; }
};

struct GgxOptions {
    bool anisotropic = false; // else the nearest isotropic lobes
    int threads = 0;          // 0: one per core
    // The source's perceptual roughness (channel 0), where it is at hand: powers end at 0.098 and 0.843.
    const Image* roughness = nullptr;
};

// alpha of the GGX lobe that looks like a lobe of this variance, 1 / power.
float alphaOfVariance(float variance);

// Throws Interrupted after Ctrl-C. `progress` counts ggxUnits().
std::vector<GgxLevel> fitGgx(const ReflectanceMips& mips, const GgxOptions& options,
                             Progress* progress = nullptr);
size_t ggxUnits(const ReflectanceMips& mips);

} // namespace lumel::baker
