#include "texels.h"
#include <array>
#include <stb/stb_dxt.h>

namespace lumel::baker {
namespace {

uint8_t byteOf(float value)
{
    return uint8_t(std::lround(std::clamp(value, 0.0f, 1.0f) * 255.0f));
}

float valueAt(const Image& image, int x, int y, int channel)
{
    const float* texel = image.at(std::min(x, image.width - 1), std::min(y, image.height - 1));
    return channel < image.channels ? texel[channel] : 1.0f;
}

std::vector<std::byte> bytesOf(const Image& image, int channels, bool srgb)
{
    std::vector<std::byte> bytes;
    bytes.reserve(size_t(image.width) * size_t(image.height) * size_t(channels));
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            for (int c = 0; c < channels; ++c) {
                const float value = valueAt(image, x, y, c);
                bytes.push_back(std::byte(byteOf(srgb && c < 3 ? linearToSrgb(value) : value)));
            }
    return bytes;
}

std::vector<std::byte> halvesOf(const Image& image)
{
    std::vector<float> values;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            for (int c = 0; c < 4; ++c)
                values.push_back(valueAt(image, x, y, c));
    std::vector<std::byte> bytes(values.size() * sizeof(uint16_t));
    floatsToHalf(values, reinterpret_cast<uint16_t*>(bytes.data()));
    return bytes;
}

// BC5 is two blocks of BC4, of the first two channels.
std::vector<std::byte> blocksOf(const Image& image, int channels)
{
    std::vector<std::byte> bytes;
    std::array<unsigned char, 16> texels{};
    std::array<unsigned char, 8> block{};
    for (int y = 0; y < image.height; y += 4)
        for (int x = 0; x < image.width; x += 4)
            for (int c = 0; c < channels; ++c) {
                for (int i = 0; i < 16; ++i)
                    texels[size_t(i)] = byteOf(valueAt(image, x + i % 4, y + i / 4, c));
                stb_compress_bc4_block(block.data(), texels.data());
                for (const unsigned char byte : block)
                    bytes.push_back(std::byte(byte));
            }
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
