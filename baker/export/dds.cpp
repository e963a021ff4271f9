#include "dds.h"
#include "byte_writer.h"
#include <array>

namespace lumel::baker {
namespace {

uint32_t dxgiFormat(TexelFormat format)
{
    switch (format) {
    case TexelFormat::rgba16f:
        return 10; // R16G16B16A16_FLOAT
    case TexelFormat::rgba8:
        return 28; // R8G8B8A8_UNORM
    case TexelFormat::rgba8Srgb:
        return 29; // R8G8B8A8_UNORM_SRGB
    case TexelFormat::r8:
        return 61; // R8_UNORM
    case TexelFormat::bc4:
        return 80; // BC4_UNORM
    case TexelFormat::bc5:
        return 83; // BC5_UNORM
    }
    return 0;
}

// Of the header before DirectX 10: flags, four characters or a number, bits and masks of R, G, B and A.
std::array<uint32_t, 7> oldPixelFormat(TexelFormat format)
{
    constexpr uint32_t kAlpha = 1, kFourCharacters = 4, kRgb = 0x40, kLuminance = 0x20000;
    const auto characters = [](const char* c) {
        return uint32_t(c[0]) | uint32_t(c[1]) << 8 | uint32_t(c[2]) << 16 | uint32_t(c[3]) << 24;
    };
    switch (format) {
    case TexelFormat::rgba16f:
        return {kFourCharacters, 113, 0, 0, 0, 0, 0}; // D3DFMT_A16B16G16R16F
    case TexelFormat::rgba8:
    case TexelFormat::rgba8Srgb:
        return {kRgb | kAlpha, 0, 32, 0xff0000, 0xff00, 0xff, 0xff000000}; // see swapRedAndBlue()
    case TexelFormat::r8:
        return {kLuminance, 0, 8, 0xff, 0, 0, 0};
    case TexelFormat::bc4:
        return {kFourCharacters, characters("BC4U"), 0, 0, 0, 0, 0};
    case TexelFormat::bc5:
        return {kFourCharacters, characters("BC5U"), 0, 0, 0, 0, 0};
    }
    return {};
}

void writePixelFormat(ByteWriter& out, TexelFormat format, DdsHeader header)
{
    out.word(32);
    if (header == DdsHeader::dx9) {
        for (const uint32_t word : oldPixelFormat(format))
            out.word(word);
        return;
    }
    out.word(4); // the DX10 header tells
    out.text("DX10");
    for (int i = 0; i < 5; ++i)
        out.word(0);
}

void writeHeader(ByteWriter& out, const ExportMap& map, TexelFormat format, DdsHeader header)
{
    const Image& finest = map.levels.front();
    const bool blocks = layoutOf(format).blockSide > 1;
    constexpr uint32_t kCaps = 1, kHeight = 2, kWidth = 4, kPitch = 8, kPixelFormat = 0x1000,
                       kMipCount = 0x20000, kLinearSize = 0x80000;
    out.text("DDS ");
    out.word(124);
    out.word(kCaps | kHeight | kWidth | kPixelFormat | kMipCount | (blocks ? kLinearSize : kPitch));
    out.word(uint32_t(finest.height));
    out.word(uint32_t(finest.width));
    out.word(uint32_t(bytesOfLevel(format, finest.width, blocks ? finest.height : 1)));
    out.word(0); // depth
    out.word(uint32_t(map.levels.size()));
    for (int i = 0; i < 11; ++i)
        out.word(0);
    writePixelFormat(out, format, header);
    out.word(0x1000 | 0x400000 | 8); // a texture, with MIPs, of several surfaces
    for (int i = 0; i < 4; ++i)
        out.word(0);
    if (header == DdsHeader::dx9)
        return;
    constexpr uint32_t kTexture2D = 3, kStraight = 1, kOpaque = 3;
    out.word(dxgiFormat(format));
    out.word(kTexture2D);
    out.word(0);
    out.word(1); // array size
    out.word(map.channels.size() == 4 ? kStraight : kOpaque);
}

// The order of D3DFMT_A8R8G8B8, which some readers take for granted.
void swapRedAndBlue(std::vector<std::byte>& texels)
{
    for (size_t i = 0; i + 3 < texels.size(); i += 4)
        std::swap(texels[i], texels[i + 2]);
}

} // namespace

std::vector<std::byte> encodeDds(const ExportMap& map, TexelStorage storage, DdsHeader header)
{
    const TexelFormat format = formatOf(map, storage);
    ByteWriter out;
    writeHeader(out, map, format, header);
    const bool isSwapped =
        header == DdsHeader::dx9 && (format == TexelFormat::rgba8 || format == TexelFormat::rgba8Srgb);
    for (const Image& level : map.levels) {
        std::vector<std::byte> texels = encodeTexels(level, format);
        if (isSwapped)
            swapRedAndBlue(texels);
        out.add(texels);
    }
    return out.take();
}

} // namespace lumel::baker
