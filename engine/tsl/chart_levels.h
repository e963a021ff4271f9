// How coarse may a lit texture get before its charts run into each other?
#pragma once
#include "texel_map.h"

namespace lumel::tsl {

// Of each level of `map`: the share of its covered lumels that belong to several charts, or lie beside a
// lumel of another, so that what is drawn from them shows seams. A chart is a set of triangles joined by
// corners that are the same in space and in the texture. Gutters of g lumels keep charts apart down to level
// log2(g) - 1 at least.
std::vector<float> seamShares(const scene::Mesh& mesh, const TexelMap& map);

// The coarsest level whose seams are few enough to be bearable.
uint32_t coarsestWithoutSeams(const std::vector<float>& shares);
inline constexpr float kSeamsBearable = 0.1f;

} // namespace lumel::tsl
