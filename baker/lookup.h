// How well a level serves as a texture: the error of bilinear lookups between its texels.
#pragma once
#include "bake.h"

namespace lumel::baker {

// Mean over `samples` places (fixed sequence) of the error, relative to the energy of the ground truth, of
// the lobe that a bilinear lookup in mips.levels[level] gives. Ground truth is the average over the box of
// one texel's size around the place.
double lookupError(const Maps& maps, const ReflectanceMips& mips, size_t level, int samples);

} // namespace lumel::baker
