// Room: which lit texture each visible object draws this frame, at which level.
#pragma once
#include "texture_pool.h"
#include <span>

namespace lumel::tsl {

// What the need pass found of one object, and its lumel grid.
struct ObjectNeed {
    bool visible = false;
    bool lightable = true; // unique UVs, opaque
    float level = 0.0f;    // finest level that any sample needs
    uint32_t samples = 0;  // of the need pass that saw it
    glm::uvec2 litSize{0}; // lumels of level 0
};

struct ObjectRoom {
    int texture = -1;      // pool texture, -1 = drawn forward
    uint32_t litLevel = 0; // the level lit into its MIP 0
};

struct Room {
    std::vector<ObjectRoom> objects;
    uint32_t levelBias = 0; // levels that everything gave up because the cap binds
};

// The level whose lumels are lit for an object that needs `level`: the finer of the two that drawing blends,
// coarser by `bias`, never past the 1 x 1 level.
uint32_t litLevelFor(float level, uint32_t bias, glm::uvec2 litSize);

// Finds room for all. When the cap binds, all objects move one level coarser together and it tries again;
// an object that finds no room even so is drawn forward.
Room assignRoom(TexturePool& pool, std::span<const ObjectNeed> needs, uint64_t frame);

} // namespace lumel::tsl
