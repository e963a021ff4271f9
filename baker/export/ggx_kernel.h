// The inner loops of fitting GGX lobes. ggx_kernel.inl holds the code once; it is compiled for the
// instruction sets of the baker's kernels (baker/fit_kernel.h). Sums are in one order and nothing is fused,
// so that all give the same bits.
#pragma once

namespace lumel::baker {

inline constexpr int kGgxPart = 32; // nodes of each of three kinds, see GgxNodes
inline constexpr int kGgxNodes = 3 * kGgxPart;

// scale / (h^T A h)^2 where n.h > 0.
struct GgxTerm {
    float form[6]; // of A: xx yy zz xy xz yz; the last three doubled
    float normal[3];
    float scale;
};

// Half vectors, each with a light.
struct GgxNodeArrays {
    alignas(64) float products[6][kGgxNodes]; // of h with itself, in the form's order
    alignas(64) float h[3][kGgxNodes];
    alignas(64) float inverseZ[kGgxNodes];
    alignas(64) float light[3][kGgxNodes];
};

// Lobes that half vectors are drawn from: normal, tangent at right angles to it, and alpha along each
// tangent; slopes in units of alpha.
struct GgxDraws {
    alignas(64) float normal[3][2 * kGgxPart];
    alignas(64) float tangent[3][2 * kGgxPart];
    alignas(64) float alphaT[2 * kGgxPart], alphaB[2 * kGgxPart];
    alignas(64) float slopeT[2 * kGgxPart], slopeB[2 * kGgxPart];
};

struct GgxKernels {
    // Sets the first 2 kGgxPart nodes.
    void (*place)(const GgxDraws& draws, GgxNodeArrays& nodes);
    // values += D(h); densities += D(h) (n.h) / h.z.
    void (*add)(const GgxNodeArrays& nodes, const GgxTerm* terms, int count, float* values, float* densities);
    // shown = c(0.3 specular + diffuse.l / pi), see ggx.h.
    void (*display)(const GgxNodeArrays& nodes, const float* specular, const float* diffuse, float* shown);
    // weights = h.z^4 / density; returns the sum of weight shown^2.
    float (*weigh)(const GgxNodeArrays& nodes, const float* densities, const float* shown, float* weights);
    // The sum of weight (shown - what a display shows of the term and the diffuse vector)^2.
    float (*error)(const GgxNodeArrays& nodes, const GgxTerm& term, const float* diffuse, const float* shown,
                   const float* weights);
};

extern const GgxKernels kGgxScalar, kGgxBaseline, kGgxAvx2, kGgxAvx512;

// Those of the set that kernels() of the baker chose.
const GgxKernels& ggxKernels();

} // namespace lumel::baker
