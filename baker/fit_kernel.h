// The inner loops of the fit, one texel a SIMD lane. fit_kernel.inl holds the code once; it is compiled
// for several instruction sets (fit_scalar.cpp, fit_avx2.cpp, ...) and the best one that the processor
// has is chosen at run time by kernels().
#pragma once

namespace lumel::baker {

inline constexpr int kMaxLanes = 16;

// Arrays named [n][lanes] hold n rows of Kernels::lanes floats, 64-byte aligned.

// Quadrature nodes on the unit disc of half vectors, each texel its own.
struct NodeBlock {
    int count = 0;
    const float* x = nullptr; // [count][lanes] unit half vectors
    const float* y = nullptr;
    const float* z = nullptr;
    const float* weight = nullptr; // [count][lanes] area in the disc, times G once averaged
};

// Lobes to average. amplitude = share of the texel's area * Ks * sqrt(det P).
struct LobeBatch {
    int count = 0;
    bool isotropic = true;
    const float* nx = nullptr; // [count][lanes]
    const float* ny = nullptr;
    const float* nz = nullptr;
    const float* pxx = nullptr; // precision P in the frame of the normal
    const float* pxy = nullptr;
    const float* pyy = nullptr;
    const float* amplitude = nullptr;
};

// A lobe as the minimiser's unknowns: N = (nx, ny) and P = I + U^T U with
// U = [e^l1, l3 e^l2; 0, e^l2], so that every unknown is free and P never drops below kMinPower = 1.
// b* is the lobe's own extent on the disc (lower Cholesky factor of its covariance there): the unit in
// which N moves. In these units the Hessian of the error near a good fit is close to the identity.
enum Unknown { kX, kY, kL1, kL2, kL3, kB11, kB21, kB22, kUnknowns };

// G as a few Gaussian lobes (fit_mixture.inl); amplitude = share * Ks * N.z.
struct MixtureBlock {
    int count = 0;
    const float* nx = nullptr; // [count][lanes]
    const float* ny = nullptr;
    const float* nz = nullptr;
    const float* sxx = nullptr;
    const float* sxy = nullptr;
    const float* syy = nullptr;
    const float* amplitude = nullptr;
};

struct FitProblem {
    NodeBlock nodes;               // weight = area * G
    MixtureBlock mixture;          // for minimiseMixture
    const float* energy = nullptr; // [lanes] <G, G>
    const float* maxLog = nullptr; // [lanes] upper bound of l1 and l2
    bool isotropic = true;         // l1 = l2, l3 = 0
    int maxEvaluations = 40;
    float tolerance = 1e-4f; // of the gradient
};

struct Kernels {
    const char* name;
    int lanes;
    // g[k] += sum over the batch of amplitude * shape at node k.
    void (*average)(const LobeBatch& batch, const NodeBlock& nodes, float* g);
    // overlap = <G, f>, norm = <f, f> of the unit-Ks lobes `unknowns` [kUnknowns][lanes]. With
    // `gradient` [5][lanes], the gradient of the error too (for tests).
    void (*evaluate)(const FitProblem& problem, const float* unknowns, float* overlap, float* norm,
                     float* gradient);
    // BFGS from `unknowns`, which it replaces by the best lobes found; error[lanes] = E / <G, G>.
    void (*minimise)(const FitProblem& problem, float* unknowns, float* error);
    // The same against the mixture.
    void (*minimiseMixture)(const FitProblem& problem, float* unknowns, float* error);
};

extern const Kernels kScalarKernels;   // one lane
extern const Kernels kBaselineKernels; // four lanes, what every 64-bit processor has
extern const Kernels kAvx2Kernels;     // eight lanes
extern const Kernels kAvx512Kernels;   // sixteen lanes

// The widest kernels that this processor runs; LUMEL_SIMD=scalar|baseline|avx2|avx512 narrows the choice.
const Kernels& kernels();

} // namespace lumel::baker
