#include "residency.h"
#include <algorithm>
#include <bit>
#include <cmath>
#include <map>

namespace lumel::tsl {
namespace {

constexpr uint64_t kDynamicTurns = 24; // frames
constexpr float kFadeStep = 1.0f / float(shared::kFadeFrames);
// Of objects that have just come to light: while they fade, both their ways are drawn.
constexpr float kEnterStep = 2.0f * kFadeStep;

glm::uvec2 textureSize(const ObjectFeedback& feedback, uint32_t litLevel)
{
    return glm::max(feedback.litSize >> litLevel, glm::uvec2(1));
}

// Smallest bias at which all visible objects fit the cap together, whatever the pool holds now.
float biasForCap(std::span<const ObjectFeedback> feedback, size_t capBytes)
{
    for (float bias = 0.0f; bias < float(shared::kMaxLevels); bias += 0.125f) {
        std::map<std::pair<uint32_t, uint32_t>, size_t> textures; // by size class
        for (const ObjectFeedback& object : feedback)
            if (object.visible && object.lightable) {
                const glm::uvec2 size = textureSize(object, litLevelFor(object.level + bias, object.litSize));
                ++textures[{size.x, size.y}];
            }
        size_t bytes = 0;
        for (const auto& [size, count] : textures)
            bytes += count * TextureLayout({size.first, size.second}).layerBytes();
        if (bytes <= capBytes)
            return bias;
    }
    return float(shared::kMaxLevels);
}

// Lumels across the object's lit texture, were it lit exactly as finely as needed.
float lumelsAcross(const ObjectFeedback& feedback)
{
    return float(std::max(feedback.litSize.x, feedback.litSize.y)) * std::exp2(-feedback.level);
}

float towards(float value, float target, float step = kFadeStep)
{
    return value < target ? std::min(value + step, target) : std::max(value - step, target);
}

} // namespace

uint32_t litLevelFor(float level, glm::uvec2 litSize)
{
    const auto log2Size = uint32_t(std::bit_width(std::max(litSize.x, litSize.y)) - 1);
    const uint32_t coarsest = log2Size - std::min(log2Size, 3u); // 8 lumels: a tile
    const auto finest = uint32_t(std::max(0.0f, std::floor(level)));
    return std::min(finest, coarsest);
}

void Residency::take(TexturePool& pool, const ObjectFeedback& feedback, size_t object, uint64_t frame)
{
    ObjectResidency& resident = objects_[object];
    const TextureId previous = resident.texture;
    const uint32_t previousLevel = resident.litLevel;
    uint32_t level = litLevelFor(feedback.level + levelBias_, feedback.litSize);
    if (previous && previousLevel + 1 == level &&
        feedback.level + levelBias_ < float(level) + kLevelHysteresis)
        level = previousLevel;

    const auto acquire = [&] {
        return pool.acquire(int(object), level, textureSize(feedback, level), frame);
    };
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
    for (const uint32_t coarsest = litLevelFor(99.0f, feedback.litSize); !texture && level < coarsest;) {
        ++level;
        texture = acquire();
    }
    // Where the previous texture's memory served, the new one may have its number.
    resident.fresh = texture && (texture != previous || level != previousLevel);
    resident.previous = resident.fresh && keepPrevious ? previous : TextureId{};
    if (resident.fresh && previous)
        resident.finest = std::max(0.0f, resident.finest + float(previousLevel) - float(level));
    else if (resident.fresh)
        resident.finest = 0.0f;
    resident.texture = texture;
    resident.litLevel = level;
}

// The object has come into view, and no sample of it is known yet: it goes on with the texture that it had.
void Residency::enter(TexturePool& pool, const ObjectFeedback& feedback, size_t object, uint64_t frame)
{
    ObjectResidency& resident = objects_[object];
    const TextureId texture = pool.latestOf(int(object));
    if (!texture ||
        pool.blocks()[size_t(texture.block)].size != textureSize(feedback, pool.texture(texture).litLevel))
        return;
    resident.texture = texture;
    resident.litLevel = pool.texture(texture).litLevel;
    resident.share = 1.0f;
    pool.touch(texture, frame);
}

void Residency::assignObject(TexturePool& pool, const ObjectFeedback& feedback, size_t object, uint64_t frame)
{
    ObjectResidency& resident = objects_[object];
    resident.fresh = false;
    resident.previous = {};
    if (!feedback.inView || !feedback.lightable) {
        resident = {};
        known_[object] = feedback.inView ? kSeen : kUnknown;
        return;
    }
    resident.finest = towards(resident.finest, 0.0f);
    if (late_ && known_[object] == kUnknown) {
        enter(pool, feedback, object, frame);
        known_[object] = kEntered;
    }
    if (!feedback.visible) // no sample met it: it keeps what it has
        return;
    const float across = lumelsAcross(feedback);
    const bool away = resident.share < 1.0f && known_[object] == kSeen;
    // Dynamic objects leave a few at a time: while one fades, both its ways are drawn.
    const bool turn = away || known_[object] != kSeen || (object + frame) % kDynamicTurns == 0;
    const bool leaves = across < (away ? kReturn : kLeave) || (feedback.dynamic && turn) ||
                        feedback.level > feedback.coarsest + (away ? kReturnLevel : kLeaveLevel);
    const float target = leaves ? 0.0f : 1.0f;
    const float step = known_[object] == kEntered ? kEnterStep : kFadeStep;
    resident.share = known_[object] == kUnknown ? target : towards(resident.share, target, step);
    if (known_[object] != kEntered || resident.share == target)
        known_[object] = kSeen;
    if (resident.share > 0.0f)
        take(pool, feedback, object, frame);
    else
        resident.texture = {};
    if (!resident.texture)
        resident.share = 0.0f;
    steady_ = steady_ && resident.share == (resident.texture ? target : 0.0f) && resident.finest == 0.0f;
}

bool Residency::anyFresh() const
{
    return std::ranges::any_of(objects_, &ObjectResidency::fresh);
}

void Residency::assign(TexturePool& pool, std::span<const ObjectFeedback> feedback, uint64_t frame, bool late)
{
    late_ = late;
    objects_.resize(feedback.size());
    known_.resize(feedback.size());
    levelBias_ = biasForCap(feedback, pool.capBytes());
    steady_ = true;
    for (size_t i = 0; i < feedback.size(); ++i) {
        ObjectResidency& resident = objects_[i];
        // A texture that was taken over while the object was out of view is no longer its own.
        if (resident.texture) {
            const PoolBlock& block = pool.blocks()[size_t(resident.texture.block)];
            if (resident.texture.layer >= block.textures.size() ||
                pool.texture(resident.texture).owner != int(i))
                resident = {};
        }
        if (resident.texture && feedback[i].inView)
            pool.touch(resident.texture, frame); // must not be taken over before it is copied from
    }
    for (size_t i = 0; i < feedback.size(); ++i)
        assignObject(pool, feedback[i], i, frame);
}

} // namespace lumel::tsl
