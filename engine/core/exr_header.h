// OpenEXR 3.1 allocates whatever a header declares, up to 2 GiB an attribute, before it reads it.
#pragma once
#include <cstddef>
#include <iosfwd>
#include <string>

namespace lumel {

// Throws Error, naming it `name`, for an EXR file of `size` bytes whose header has attributes that reach past
// its end, tiles of more than 2^22 texels, or more than kMaxImagePixels. Anything else is left to OpenEXR,
// and so is what is no EXR file.
void checkExrHeader(std::istream& stream, size_t size, const std::string& name);

} // namespace lumel
