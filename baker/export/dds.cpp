#include "dds.h"
#include "byte_writer.h"

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

void writeHeader(ByteWriter& out, const ExportMap& map, TexelFormat format)
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
    out.word(32); // the pixel format: see the DX10 header
    out.word(4);
    out.text("DX10");
    for (int i = 0; i < 5; ++i)
        out.word(0);
    out.word(0x1000 | 0x400000 | 8); // a texture, with MIPs, of several surfaces
    for (int i = 0; i < 4; ++i)
        out.word(0);
    constexpr uint32_t kTexture2D = 3, kStraight = 1, kOpaque = 3;
    out.word(dxgiFormat(format));
    out.word(kTexture2D);
    out.word(0);
    out.word(1); // array size
    out.word(map.channels.size() == 4 ? kStraight : kOpaque);
}

} // namespace

std::vector<std::byte> encodeDds(const ExportMap& map, TexelStorage storage)
{
    const TexelFormat format = formatOf(map, storage);
    ByteWriter out;
    writeHeader(out, map, format);
    for (const Image& level : map.levels)
        out.add(encodeTexels(level, format));
    return out.take();
}

} // namespace lumel::baker
