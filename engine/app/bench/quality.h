// How far frames are from the reference's, one by one and in how they change.
#pragma once
#include "core/image.h"

namespace lumel::bench {

// Root mean square of a - b. Same size, display values.
double rmseOf(const Image& a, const Image& b);

// Root mean square of (now - before) - (referenceNow - referenceBefore): what flickers though it should not,
// or stays though it should change. 0 for an error that does not change.
double flickerOf(const Image& before, const Image& now, const Image& referenceBefore,
                 const Image& referenceNow);

} // namespace lumel::bench
