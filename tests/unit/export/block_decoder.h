// BC4 and BC5 as the Direct3D 11 specification decodes them (section 19.5.13): two ends and six values
// between.
#pragma once
#include "core/image.h"
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace lumel::baker::test {

inline std::array<float, 16> decodeBc4(std::span<const std::byte> block)
{
    const float a = float(block[0]) / 255.0f, b = float(block[1]) / 255.0f;
    std::array<float, 8> palette{a, b};
    if (block[0] > block[1]) {
        for (int i = 1; i < 7; ++i)
            palette[size_t(i) + 1] = (float(7 - i) * a + float(i) * b) / 7.0f;
    } else {
        for (int i = 1; i < 5; ++i)
            palette[size_t(i) + 1] = (float(5 - i) * a + float(i) * b) / 5.0f;
        palette[6] = 0.0f;
        palette[7] = 1.0f;
    }
    uint64_t indices = 0;
    for (size_t i = 0; i < 6; ++i)
        indices |= uint64_t(block[2 + i]) << (8 * i);
    std::array<float, 16> texels{};
    for (size_t i = 0; i < 16; ++i)
        texels[i] = palette[indices >> (3 * i) & 7];
    return texels;
}

// A level of BC4 (one channel) or BC5 (two).
inline Image decodeBlocks(std::span<const std::byte> bytes, int width, int height, int channels)
{
    Image image(width, height, channels);
    const int across = (width + 3) / 4;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (int c = 0; c < channels; ++c) {
                const size_t block = size_t(y / 4 * across + x / 4) * size_t(channels) + size_t(c);
                image.at(x, y)[c] = decodeBc4(bytes.subspan(8 * block, 8))[size_t(y % 4 * 4 + x % 4)];
            }
    return image;
}

} // namespace lumel::baker::test
