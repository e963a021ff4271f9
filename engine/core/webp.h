// WebP by libwebp itself: OpenImageIO 2.4 multiplies colours by alpha whatever it is told, and allocates the
// picture before anyone can look at its size.
#pragma once
#include <cstddef>
#include <span>

namespace lumel {

struct WebpSize {
    int width = 0, height = 0, channels = 0; // 3, or 4 with alpha
};

// Both throw Error for what is damaged or animated. The second writes 8-bit samples, row by row.
WebpSize readWebpSize(std::span<const std::byte> bytes);
void readWebp(std::span<const std::byte> bytes, const WebpSize& size, std::byte* pixels);

} // namespace lumel
