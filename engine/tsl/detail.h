// Detail: how finely a view is lit. One lumel per pixel across takes many lumels where surfaces are seen at a
// grazing angle; a bound on them gives up the length of footprints first, then the size of lumels.
#pragma once
#include "shared/structs.h"
#include <array>
#include <optional>

namespace lumel::tsl {

// Pixels by how long their footprints are: bin i counts those whose longer axis is 2^((i + 0.5) /
// kElongationsAnOctave) times the shorter. Magnified pixels count as the share of a lumel that they see.
using Elongations = std::array<float, shared::kElongations>;

struct Detail {
    float levelOffset = 0.0f; // levels coarser than one lumel per pixel across
    float anisotropy = 1.0f;  // a footprint counts as at most so many times longer than wide

    bool operator==(const Detail&) const = default;
};

// The least anisotropy that a bound on lumels leaves: below it, the blur along footprints shows more than
// coarser lumels do (measured on the examples).
inline constexpr float kLeastAnisotropy = 2.0f;

// Lumels that `detail` takes, for each of `pixels`. Seen at a grazing angle, a pixel takes as many as its
// footprint is longer than wide; beyond the anisotropy its lumels grow, as a square.
float lumelsPerPixel(const Elongations& elongations, float pixels, const Detail& detail);

// The finest detail, at most `finest`, at which a view stays within `lumelsPerPixel`. `before`: that of the
// frame before, which is kept while it is within an eighth of an octave, and else followed slowly.
Detail detailFor(const Elongations& elongations, float pixels, const Detail& finest, float lumelsPerPixel,
                 const std::optional<Detail>& before);

} // namespace lumel::tsl
