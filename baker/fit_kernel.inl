// Included by the fit_*.cpp files, which define LUMEL_LANES, LUMEL_KERNELS and LUMEL_NAME.
#include "fit_kernel.h"

namespace lumel::baker {
namespace {
#include "fit_simd.inl"

#include "fit_lobe.inl"

#include "fit_average.inl"

#include "fit_exact.inl"

#include "fit_judge.inl"

#include "fit_mixture.inl"

#include "fit_pair.inl"

#include "fit_search.inl"
} // namespace

extern const Kernels LUMEL_KERNELS;
const Kernels LUMEL_KERNELS = {LUMEL_NAME, W, average, shapeOnLattice, toHalfVectors,
                               minimise, minimiseMixtures, minimisePairs, minimisePairMixtures, mixtureEnergy, mixtureOverlaps, judge, evaluate, evaluatePair};

} // namespace lumel::baker
