#include "room.h"
#include "shared/structs.h"
#include <algorithm>
#include <bit>
#include <cmath>

namespace lumel::tsl {
namespace {

glm::uvec2 textureSize(const ObjectNeed& need, uint32_t litLevel)
{
    return glm::max(need.litSize >> litLevel, glm::uvec2(1));
}

// Smallest bias at which all visible objects fit the cap together, whatever the pool holds now.
uint32_t biasForCap(std::span<const ObjectNeed> needs, size_t capBytes)
{
    for (uint32_t bias = 0; bias < shared::kMaxLevels; ++bias) {
        size_t bytes = 0;
        for (const ObjectNeed& need : needs)
            if (need.visible && need.lightable)
                bytes += poolTextureBytes(textureSize(need, litLevelFor(need.level, bias, need.litSize)));
        if (bytes <= capBytes)
            return bias;
    }
    return shared::kMaxLevels;
}

} // namespace

uint32_t litLevelFor(float level, uint32_t bias, glm::uvec2 litSize)
{
    const auto coarsest = uint32_t(std::bit_width(std::max(litSize.x, litSize.y)) - 1);
    const auto finest = uint32_t(std::max(0.0f, std::floor(level)));
    return std::min(finest + bias, coarsest);
}

Room assignRoom(TexturePool& pool, std::span<const ObjectNeed> needs, uint64_t frame)
{
    Room room;
    room.levelBias = biasForCap(needs, pool.capBytes());
    room.objects.resize(needs.size());
    for (size_t i = 0; i < needs.size(); ++i) {
        if (!needs[i].visible || !needs[i].lightable)
            continue;
        const uint32_t level = litLevelFor(needs[i].level, room.levelBias, needs[i].litSize);
        if (const auto texture = pool.acquire(int(i), textureSize(needs[i], level), frame))
            room.objects[i] = {*texture, level};
    }
    return room;
}

} // namespace lumel::tsl
