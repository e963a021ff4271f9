#include "detail.h"
#include <algorithm>
#include <cmath>

namespace lumel::tsl {
namespace {

// Whole levels are finer than the fractional one asked for: 4^f over f from 0 to 1 is 2.16. Where both of two
// levels are blended, and at the borders of what is seen, lumels come on top (measured on the examples).
constexpr float kOverhead = 2.45f;

// Detail as one number: the octaves that `finest` gives up, first of anisotropy, then of the lumels' size.
float octavesOfAnisotropy(const Detail& finest)
{
    return std::max(std::log2(finest.anisotropy / kLeastAnisotropy), 0.0f);
}

Detail reduced(const Detail& finest, float octaves)
{
    const float anisotropy = std::min(octaves, octavesOfAnisotropy(finest));
    return {finest.levelOffset + octaves - anisotropy, finest.anisotropy * std::exp2(-anisotropy)};
}

float octavesBelow(const Detail& finest, const Detail& detail)
{
    return std::log2(finest.anisotropy / detail.anisotropy) + detail.levelOffset - finest.levelOffset;
}

} // namespace

float lumelsPerPixel(const Elongations& elongations, float pixels, const Detail& detail)
{
    float lumels = 0.0f;
    for (size_t i = 0; i < elongations.size(); ++i) {
        const float longer = std::exp2((float(i) + 0.5f) / float(shared::kElongationsPerOctave));
        const float a = detail.anisotropy;
        lumels += elongations[i] * (longer <= a ? longer : a * a / longer);
    }
    return pixels > 0.0f ? kOverhead * lumels / pixels * std::exp2(-2.0f * detail.levelOffset) : 0.0f;
}

Detail detailFor(const Elongations& elongations, float pixels, const Detail& finest, float most,
                 const std::optional<Detail>& before)
{
    float low = 0.0f, high = float(shared::kMaxLevels) + octavesOfAnisotropy(finest);
    if (lumelsPerPixel(elongations, pixels, finest) <= most)
        high = 0.0f;
    for (int i = 0; i < 20 && high > 0.0f; ++i) {
        const float middle = 0.5f * (low + high);
        (lumelsPerPixel(elongations, pixels, reduced(finest, middle)) > most ? low : high) = middle;
    }
    if (!before)
        return reduced(finest, high);
    constexpr float kTolerated = 1.0f / 8.0f, kStep = 1.0f / 32.0f; // per frame: no visible jump
    const float now = octavesBelow(finest, *before);
    return std::abs(high - now) <= kTolerated ? *before
                                              : reduced(finest, now + std::clamp(high - now, -kStep, kStep));
}

} // namespace lumel::tsl
