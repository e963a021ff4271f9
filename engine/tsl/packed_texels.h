// A texel map as shaders read it: see kTexelTriangleMask and kTexelsListed in shared/structs.h. Most tiles
// lie within one triangle or touch a few, so that this is a small part of the map's 4 bytes a lumel.
#pragma once
#include "texel_map.h"

namespace lumel::tsl {

struct PackedTexels {
    std::array<uint32_t, shared::kMaxLevels> offsets{}; // two words for each tile of a level begin here
    UninitialisedArray<uint32_t> words;
};

PackedTexels pack(const TexelMap& map);

} // namespace lumel::tsl
