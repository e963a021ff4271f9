// WebP by libwebp itself: OpenImageIO 2.4 multiplies colours by alpha whatever it is told, and allocates the
// picture before anyone can look at its size.
#pragma once
#include "image.h"

namespace lumel {

bool isWebp(std::span<const std::byte> bytes);

// Throws Error, naming it `name`, for what is damaged, animated or too large.
Image readWebp(std::span<const std::byte> bytes, const std::string& name);

} // namespace lumel
