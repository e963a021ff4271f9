// OpenEXR 3.1 allocates whatever a header declares, up to 2 GiB an attribute, before it reads it.
#pragma once
#include <cstddef>
#include <span>

namespace lumel {

// Throws Error for an EXR file whose header has attributes that reach past its end, tiles of more than 2^22
// texels, or more than kMaxImagePixels. Anything else is left to OpenEXR.
void checkExrHeader(std::span<const std::byte> bytes);

} // namespace lumel
