// Which of a texel's two lobes is the first. Interpolation blends the first lobes of neighbours, and their
// second ones: the same feature should have the same place in all of them.
#pragma once
#include "bake.h"

namespace lumel::baker {

// Swaps lobes of texels so that neighbours, and finer levels with coarser ones, correspond.
void orderLobes(std::vector<Level>& levels, Wrap wrap, class Profile* profile = nullptr);

} // namespace lumel::baker
