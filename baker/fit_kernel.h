// The inner loops of the fit. fit_kernel.inl holds the code once; it is compiled for several instruction
// sets (fit_scalar.cpp, fit_avx2.cpp, ...) and the best one that the processor has is chosen at run time
// by kernels().
#pragma once

namespace lumel::baker {

inline constexpr int kMaxLanes = 16;

// Quadrature nodes on the unit disc of half vectors. `count` is a multiple of kMaxLanes; what pads it
// has no area.
struct NodeList {
    int count = 0;
    const float* x = nullptr; // unit half vectors
    const float* y = nullptr;
    const float* z = nullptr;
    const float* weight = nullptr; // area of the disc, times G once averaged
};

// A lobe to average. amplitude = share of the texel's area * Ks * sqrt(det P); P in the normal's frame.
struct LobeTerm {
    float nx, ny, nz, pxx, pxy, pyy, amplitude;
};

// A lobe as the minimiser's unknowns: N = (x, y) and P = kBase I + U^T U with U = [e^l1, l3 e^l2; 0,
// e^l2]. Every unknown is free but for simple bounds, and P stays well above 0. b* is the lobe's own
// extent on the disc (lower Cholesky factor of its covariance there): the unit in which N moves. In
// these units the Hessian of the error near a good fit is close to the identity.
inline constexpr float kBase = 0.5f;
inline constexpr float kLowestLog = -0.34657359f; // of l1 and l2: ln(kMinPower - kBase) / 2
enum Unknown { kX, kY, kL1, kL2, kL3, kB11, kB21, kB22, kUnknowns };

// G as a few lobes (fit_mixture.inl): covariance (P + I)^-1 in the normal's frame, and
// amplitude = share * Ks * sqrt(det P / det(P + I)).
struct MixtureTerm {
    float nx, ny, nz, sxx, sxy, syy, amplitude;
};

// One search: a texel and a start.
struct FitJob {
    NodeList nodes;                       // weight = area * G
    const MixtureTerm* mixture = nullptr; // for minimiseMixtures
    int mixtureCount = 0;
    float energy = 1.0f;       // <G, G>
    float maxLog = 10.0f;      // upper bound of l1 and l2
    float unknowns[kUnknowns]; // start, then the best point found
    float error = 1.0f;        // E / <G, G> there, with the best Ks
    float norm = 1.0f;         // <f, f> there
};

// A search for two lobes at once, F = F1 + F2: both shapes from their starts, both Ks by projection, none
// below 0.
struct PairJob {
    NodeList nodes;                       // weight = area * G
    const float* area = nullptr;          // of the nodes
    const MixtureTerm* mixture = nullptr; // for minimisePairMixtures
    int mixtureCount = 0;
    float energy = 1.0f;          // <G, G>
    float maxLog = 10.0f;         // upper bound of l1 and l2
    float unknowns[2][kUnknowns]; // starts, then the best point found
    float error = 1.0f;           // E / <G, G> there
    float ks[2], norm[2];         // best Ks and <f, f> of each
    float cross;                  // <f1, f2>
};

// A lobe to be judged as it is, without a search.
struct Trial {
    NodeList nodes;      // weight = area * G
    float energy;        // <G, G>
    float nx, ny;        // |N.xy| < 1
    float pxx, pxy, pyy; // P in the normal's frame
    float error, norm;   // found: E / <G, G> with the best Ks, and <f, f>
};

struct SearchSettings {
    bool isotropic = true;   // l1 = l2, l3 = 0
    int maxEvaluations = 40; // 1: only evaluates the starts
    float tolerance = 3e-3f; // of the gradient; the error then is within about half its square of the minimum
};

struct Kernels {
    const char* name;
    int lanes;
    // g[k] += sum over the lobes of amplitude * shape at node k.
    void (*average)(const LobeTerm* lobes, int count, bool isotropic, const NodeList& nodes, float* g);
    // f[k] = shape / sqrt(det P) of the lobe at the point (cx + x[k], cy + y[k]) * spacing of Lambert's map
    // (quadrature.h); 0 beyond the disc.
    void (*shapeOnLattice)(const LobeTerm& lobe, bool isotropic, const float* x, const float* y, int count,
                           float cx, float cy, float spacing, float* f);
    // Points of Lambert's map and areas there, in `spacing`s, to half vectors and areas of the disc, in
    // place.
    void (*toHalfVectors)(float* x, float* y, float* z, float* area, int count, float spacing);
    // BFGS on `count` jobs against their nodes, one a lane; a lane that is done takes the next job. What a
    // job finds does not depend on the others.
    void (*minimise)(FitJob* const* jobs, int count, const SearchSettings& settings);
    // The same against the mixtures; `scratch` holds 7 * kMaxLanes floats for each term of the largest. Lanes
    // run through their terms together, so jobs of like term counts belong together.
    void (*minimiseMixtures)(FitJob* const* jobs, int count, const SearchSettings& settings, float* scratch);
    // Searches for two lobes, against nodes and against mixtures.
    void (*minimisePairs)(PairJob* const* jobs, int count, const SearchSettings& settings);
    void (*minimisePairMixtures)(PairJob* const* jobs, int count, const SearchSettings& settings,
                                 float* scratch);
    // <G, G> of a mixture.
    float (*mixtureEnergy)(const MixtureTerm* terms, int count);
    // <F_i, f> for each component and a lobe.
    void (*mixtureOverlaps)(const MixtureTerm* terms, int count, const MixtureTerm& lobe, float* overlaps);
    // The errors of lobes: what one evaluation of a search costs without its gradient, or less.
    void (*judge)(Trial* trials, int count);
    // <G, f> and <f, f> of one job at its unknowns, and the gradient of its error in the first five.
    void (*evaluate)(const FitJob& job, float* overlap, float* norm, float* gradient);
    // The error of two lobes at their unknowns against the nodes or the mixture, and its gradient in the
    // first five of each. Nodes need no scratch.
    float (*evaluatePair)(const PairJob& job, bool exact, float* gradient, float* scratch);
};

extern const Kernels kScalarKernels;   // one lane
extern const Kernels kBaselineKernels; // four lanes, what every 64-bit processor has
extern const Kernels kAvx2Kernels;     // eight lanes
extern const Kernels kAvx512Kernels;   // sixteen lanes

// The widest kernels that this processor runs; LUMEL_SIMD=scalar|baseline|avx2|avx512 narrows the choice.
const Kernels& kernels();

} // namespace lumel::baker
