#include "room.h"
#include <algorithm>
#include <bit>
#include <cmath>
#include <map>

namespace lumel::tsl {
namespace {

constexpr uint64_t kRestlessTurns = 24; // frames
constexpr float kFadeStep = 1.0f / float(shared::kFadeFrames);

glm::uvec2 textureSize(const ObjectNeed& need, uint32_t litLevel)
{
    return glm::max(need.litSize >> litLevel, glm::uvec2(1));
}

// Smallest bias at which all visible objects fit the cap together, whatever the pool holds now.
float biasForCap(std::span<const ObjectNeed> needs, size_t capBytes)
{
    for (float bias = 0.0f; bias < float(shared::kMaxLevels); bias += 0.125f) {
        std::map<std::pair<uint32_t, uint32_t>, size_t> textures; // by size class
        for (const ObjectNeed& need : needs)
            if (need.visible && need.lightable) {
                const glm::uvec2 size = textureSize(need, litLevelFor(need.level + bias, need.litSize));
                ++textures[{size.x, size.y}];
            }
        size_t bytes = 0;
        for (const auto& [size, count] : textures) {
            const TextureLayout layout({size.first, size.second});
            bytes += (count + layout.layers - 1) / layout.layers * layout.blockBytes();
        }
        if (bytes <= capBytes)
            return bias;
    }
    return float(shared::kMaxLevels);
}

// Lumels across the object's lit texture, were it lit exactly as finely as needed.
float lumelsAcross(const ObjectNeed& need)
{
    return float(std::max(need.litSize.x, need.litSize.y)) * std::exp2(-need.level);
}

float towards(float value, float target)
{
    return value < target ? std::min(value + kFadeStep, target) : std::max(value - kFadeStep, target);
}

} // namespace

uint32_t litLevelFor(float level, glm::uvec2 litSize)
{
    const auto log2Size = uint32_t(std::bit_width(std::max(litSize.x, litSize.y)) - 1);
    const uint32_t coarsest = log2Size - std::min(log2Size, 3u); // 8 lumels: a tile
    const auto finest = uint32_t(std::max(0.0f, std::floor(level)));
    return std::min(finest, coarsest);
}

void Rooms::take(TexturePool& pool, const ObjectNeed& need, size_t object, uint64_t frame)
{
    ObjectRoom& room = objects_[object];
    const TextureId previous = room.texture;
    const uint32_t previousLevel = room.litLevel;
    uint32_t level = litLevelFor(need.level + levelBias_, need.litSize);
    if (previous && previousLevel + 1 == level && need.level + levelBias_ < float(level) + kLevelHysteresis)
        level = previousLevel;

    const auto acquire = [&] { return pool.acquire(int(object), level, textureSize(need, level), frame); };
    TextureId texture = acquire();
    const bool keepPrevious = bool(texture);
    if (!texture && previous && previousLevel < level && levelBias_ == 0.0f) {
        texture = previous; // finer than needed, but lit
        level = previousLevel;
    }
    if (!texture && previous) {
        pool.touch(previous, 0); // its memory may serve
        texture = acquire();
    }
    for (const uint32_t coarsest = litLevelFor(99.0f, need.litSize); !texture && level < coarsest;) {
        ++level;
        texture = acquire();
    }
    // Where the previous texture's memory served, the new one may have its number.
    room.fresh = texture && (texture != previous || level != previousLevel);
    room.previous = room.fresh && keepPrevious ? previous : TextureId{};
    if (room.fresh && previous)
        room.finest = std::max(0.0f, room.finest + float(previousLevel) - float(level));
    else if (room.fresh)
        room.finest = 0.0f;
    room.texture = texture;
    room.litLevel = level;
}

void Rooms::assignObject(TexturePool& pool, const ObjectNeed& need, size_t object, uint64_t frame)
{
    ObjectRoom& room = objects_[object];
    room.fresh = false;
    room.previous = {};
    if (!need.inView || !need.lightable) {
        room = {};
        known_[object] = need.inView;
        return;
    }
    room.finest = towards(room.finest, 0.0f);
    if (!need.visible) // no sample met it: it keeps what it has
        return;
    const float across = lumelsAcross(need);
    const bool away = room.share < 1.0f && known_[object];
    // Restless objects leave a few at a time: while one fades, both its ways are drawn.
    const bool turn = away || !known_[object] || (object + frame) % kRestlessTurns == 0;
    const bool leaves = across < (away ? kReturn : kLeave) || (need.restless && turn) ||
                        need.level > need.coarsest + (away ? kReturnLevel : kLeaveLevel);
    const float target = leaves ? 0.0f : 1.0f;
    room.share = known_[object] ? towards(room.share, target) : target;
    known_[object] = 1;
    if (room.share > 0.0f)
        take(pool, need, object, frame);
    else
        room.texture = {};
    if (!room.texture)
        room.share = 0.0f;
    steady_ = steady_ && room.share == (room.texture ? target : 0.0f) && room.finest == 0.0f;
}

void Rooms::assign(TexturePool& pool, std::span<const ObjectNeed> needs, uint64_t frame)
{
    objects_.resize(needs.size());
    known_.resize(needs.size());
    levelBias_ = biasForCap(needs, pool.capBytes());
    steady_ = true;
    for (size_t i = 0; i < needs.size(); ++i) {
        ObjectRoom& room = objects_[i];
        // A texture that was taken over while the object was out of view is no longer its own.
        if (room.texture) {
            const PoolBlock& block = pool.blocks()[size_t(room.texture.block)];
            if (room.texture.layer >= block.textures.size() || pool.texture(room.texture).owner != int(i))
                room = {};
        }
        if (room.texture && needs[i].inView)
            pool.touch(room.texture, frame); // not to be taken over before it is copied from
    }
    for (size_t i = 0; i < needs.size(); ++i)
        assignObject(pool, needs[i], i, frame);
}

} // namespace lumel::tsl
