// The picture on the record's label: a sun over water, and a name in letters drawn as strokes.
#pragma once
#include "core/image.h"

namespace lumel::assets {

inline constexpr float kLabelRadius = 50.0f;    // mm, the paper label of an LP is 100 mm across
inline constexpr float kLabelMapWidth = 102.0f; // mm, with space for the rounded edge

Image makeLabel(int size);

} // namespace lumel::assets
