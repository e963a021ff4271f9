// A texel map as shaders read it: see kTexelTriangleMask in shared/structs.h.
#pragma once
#include "texel_map.h"

namespace lumel::tsl {

struct PackedTexels {
    std::array<uint32_t, shared::kMaxLevels> offsets{}; // first word of each level
    // Of each level: a texel for each lumel, then for each tile two masks of its quads: those that hold
    // surface or gutter, and in the high half those that surface covers whole.
    UninitialisedArray<uint32_t> words;
};

PackedTexels pack(const TexelMap& map);

} // namespace lumel::tsl
