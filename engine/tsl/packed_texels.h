// A texel map as shaders read it: see kTexelTriangleMask in shared/structs.h.
#pragma once
#include "texel_map.h"

namespace lumel::tsl {

struct PackedTexels {
    std::array<uint32_t, shared::kMaxLevels> offsets{}; // first word of each level
    // Of each level: a texel for each lumel, then for each tile the mask of its quads that hold surface or
    // gutter.
    UninitialisedArray<uint32_t> words;
};

PackedTexels pack(const TexelMap& map);

} // namespace lumel::tsl
