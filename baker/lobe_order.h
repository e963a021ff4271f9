// Which of a texel's two lobes is the first: interpolation blends first lobes with first ones, so neighbours
// should agree.
#pragma once
#include "bake.h"

namespace lumel::baker {

// Swaps lobes of texels so that neighbours within a level, and levels, correspond.
void orderLobes(std::vector<Level>& levels);

} // namespace lumel::baker
