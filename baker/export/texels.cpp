#include "texels.h"
#include <array>
#include <stb/stb_dxt.h>
#include <tbb/parallel_for.h>

namespace lumel::baker {
namespace {

// The nearest, halves upwards.
uint8_t byteOf(float value)
{
    const float scaled = std::clamp(value, 0.0f, 1.0f) * 255.0f;
    const int below = int(scaled);
    return uint8_t(below + (scaled - float(below) >= 0.5f ? 1 : 0));
}

float valueAt(const Image& image, int x, int y, int channel)
{
    const float* texel = image.at(std::min(x, image.width - 1), std::min(y, image.height - 1));
    return channel < image.channels ? texel[channel] : 1.0f;
}

std::vector<std::byte> bytesOf(const Image& image, int channels, bool srgb)
{
    const size_t row = size_t(image.width) * size_t(channels);
    std::vector<std::byte> bytes(row * size_t(image.height));
    tbb::parallel_for(0, image.height, [&](int y) {
        std::byte* to = bytes.data() + row * size_t(y);
        for (int x = 0; x < image.width; ++x)
            for (int c = 0; c < channels; ++c) {
                const float value = valueAt(image, x, y, c);
                *to++ = std::byte(byteOf(srgb && c < 3 ? linearToSrgb(value) : value));
            }
    });
    return bytes;
}

std::vector<std::byte> halvesOf(const Image& image)
{
    const size_t row = 4 * size_t(image.width);
    std::vector<std::byte> bytes(row * size_t(image.height) * sizeof(uint16_t));
    tbb::parallel_for(0, image.height, [&](int y) {
        std::vector<float> values(row);
        for (size_t i = 0; i < row; ++i)
            values[i] = valueAt(image, int(i / 4), y, int(i % 4));
        floatsToHalf(values, reinterpret_cast<uint16_t*>(bytes.data()) + row * size_t(y));
    });
    return bytes;
}

// BC5 is two blocks of BC4, of the first two channels.
std::vector<std::byte> blocksOf(const Image& image, int channels)
{
    constexpr size_t kBlock = 8; // bytes
    const int columns = (image.width + 3) / 4, rows = (image.height + 3) / 4;
    const size_t row = size_t(columns) * size_t(channels) * kBlock;
    std::vector<std::byte> bytes(row * size_t(rows));
    tbb::parallel_for(0, rows, [&](int y) {
        auto* to = reinterpret_cast<unsigned char*>(bytes.data() + row * size_t(y));
        std::array<unsigned char, 16> texels{};
        for (int x = 0; x < columns; ++x)
            for (int c = 0; c < channels; ++c, to += kBlock) {
                for (int i = 0; i < 16; ++i)
                    texels[size_t(i)] = byteOf(valueAt(image, 4 * x + i % 4, 4 * y + i / 4, c));
                stb_compress_bc4_block(to, texels.data());
            }
    });
    return bytes;
}

} // namespace

TexelFormat formatOf(const ExportMap& map, TexelStorage storage)
{
    if (storage == TexelStorage::halves)
        return TexelFormat::rgba16f;
    if (map.channels.size() == 1)
        return storage == TexelStorage::blocks ? TexelFormat::bc4 : TexelFormat::r8;
    if (map.isNormal && storage == TexelStorage::blocks)
        return TexelFormat::bc5;
    return map.colourSpace == ColourSpace::srgb ? TexelFormat::rgba8Srgb : TexelFormat::rgba8;
}

TexelLayout layoutOf(TexelFormat format)
{
    switch (format) {
    case TexelFormat::r8:
        return {1, 1};
    case TexelFormat::rgba8:
    case TexelFormat::rgba8Srgb:
        return {1, 4};
    case TexelFormat::rgba16f:
        return {1, 8};
    case TexelFormat::bc4:
        return {4, 8};
    case TexelFormat::bc5:
        return {4, 16};
    }
    return {1, 1};
}

size_t bytesOfLevel(TexelFormat format, int width, int height)
{
    const auto [side, bytes] = layoutOf(format);
    const auto blocks = [s = side](int size) { return size_t((size + s - 1) / s); };
    return blocks(width) * blocks(height) * size_t(bytes);
}

std::vector<std::byte> encodeTexels(const Image& image, TexelFormat format)
{
    switch (format) {
    case TexelFormat::r8:
        return bytesOf(image, 1, false);
    case TexelFormat::rgba8:
    case TexelFormat::rgba8Srgb:
        return bytesOf(image, 4, format == TexelFormat::rgba8Srgb);
    case TexelFormat::rgba16f:
        return halvesOf(image);
    case TexelFormat::bc4:
        return blocksOf(image, 1);
    case TexelFormat::bc5:
        return blocksOf(image, 2);
    }
    return {};
}

} // namespace lumel::baker
