#include "ktx2.h"
#include "byte_writer.h"
#include "core/error.h"
#include <fmt/format.h>
#include <zstd.h>

namespace lumel::baker {
namespace {

constexpr int kZstandardLevel = 9; // above it, files shrink by few per cent and take several times as long

uint32_t vulkanFormat(TexelFormat format)
{
    switch (format) {
    case TexelFormat::r8:
        return 9; // VK_FORMAT_R8_UNORM
    case TexelFormat::rgba8:
        return 37; // R8G8B8A8_UNORM
    case TexelFormat::rgba8Srgb:
        return 43; // R8G8B8A8_SRGB
    case TexelFormat::rgba16f:
        return 97; // R16G16B16A16_SFLOAT
    case TexelFormat::bc4:
        return 139; // BC4_UNORM_BLOCK
    case TexelFormat::bc5:
        return 141; // BC5_UNORM_BLOCK
    }
    return 0;
}

// A sample of the descriptor: where a channel's bits lie and which numbers mean 0 and 1.
struct Sample {
    uint32_t channel, bits, lower, upper;
};

std::vector<Sample> samplesOf(TexelFormat format)
{
    constexpr uint32_t kAlpha = 15, kLinear = 0x10, kSigned = 0x40, kFloat = 0x80;
    constexpr uint32_t kMinusOne = 0xbf800000u, kOne = 0x3f800000u; // as floats
    switch (format) {
    case TexelFormat::r8:
        return {{0, 8, 0, 255}};
    case TexelFormat::rgba8:
        return {{0, 8, 0, 255}, {1, 8, 0, 255}, {2, 8, 0, 255}, {kAlpha, 8, 0, 255}};
    case TexelFormat::rgba8Srgb:
        return {{0, 8, 0, 255}, {1, 8, 0, 255}, {2, 8, 0, 255}, {kAlpha | kLinear, 8, 0, 255}};
    case TexelFormat::rgba16f: {
        constexpr uint32_t kHalf = kSigned | kFloat;
        return {{0 | kHalf, 16, kMinusOne, kOne},
                {1 | kHalf, 16, kMinusOne, kOne},
                {2 | kHalf, 16, kMinusOne, kOne},
                {kAlpha | kHalf, 16, kMinusOne, kOne}};
    }
    case TexelFormat::bc4:
        return {{0, 64, 0, 0xffffffffu}};
    case TexelFormat::bc5:
        return {{0, 64, 0, 0xffffffffu}, {1, 64, 0, 0xffffffffu}};
    }
    return {};
}

std::vector<std::byte> descriptor(TexelFormat format)
{
    constexpr uint32_t kRgb = 1, kBc4 = 131, kBc5 = 132, kBt709 = 1, kLinearTransfer = 1, kSrgbTransfer = 2;
    const std::vector<Sample> samples = samplesOf(format);
    const auto [side, bytes] = layoutOf(format);
    const uint32_t model = format == TexelFormat::bc4 ? kBc4 : format == TexelFormat::bc5 ? kBc5 : kRgb;
    const uint32_t transfer = format == TexelFormat::rgba8Srgb ? kSrgbTransfer : kLinearTransfer;
    const uint32_t blockBytes = 24 + 16 * uint32_t(samples.size()), last = uint32_t(side - 1);
    ByteWriter out;
    out.word(4 + blockBytes);
    out.word(0);                    // Khronos, basic format
    out.word(2 | blockBytes << 16); // version 1.3
    out.word(model | kBt709 << 8 | transfer << 16);
    out.word(last | last << 8); // the block's width and height less one
    out.word(uint32_t(bytes));  // of plane 0
    out.word(0);
    uint32_t offset = 0;
    for (const Sample& s : samples) {
        out.word(offset | (s.bits - 1) << 16 | s.channel << 24);
        out.word(0); // position
        out.word(s.lower);
        out.word(s.upper);
        offset += s.bits;
    }
    return out.take();
}

std::vector<std::byte> keyValues()
{
    ByteWriter out;
    const auto add = [&](const std::string& key, const std::string& value) {
        out.word(uint32_t(key.size() + value.size() + 2));
        out.text(key + '\0' + value + '\0');
        out.padTo(4);
    };
    add("KTXorientation", "rd"); // rows from the top; keys in alphabetical order
    add("KTXwriter", "lumel");
    return out.take();
}

std::vector<std::byte> supercompressed(const std::vector<std::byte>& bytes)
{
    std::vector<std::byte> result(ZSTD_compressBound(bytes.size()));
    const size_t size =
        ZSTD_compress(result.data(), result.size(), bytes.data(), bytes.size(), kZstandardLevel);
    if (ZSTD_isError(size))
        throw Error(
            fmt::format("a texture cannot be compressed ({}); leave out --zstd", ZSTD_getErrorName(size)));
    result.resize(size);
    return result;
}

} // namespace

std::vector<std::byte> encodeKtx2(const ExportMap& map, TexelStorage storage, bool zstandard)
{
    const TexelFormat format = formatOf(map, storage);
    const Image& finest = map.levels.front();
    const std::vector<std::byte> dfd = descriptor(format), pairs = keyValues();
    const uint32_t levels = uint32_t(map.levels.size());
    constexpr size_t kHeaderBytes = 80, kLevelBytes = 24;
    const uint32_t dfdAt = uint32_t(kHeaderBytes + kLevelBytes * levels);
    ByteWriter out;
    out.text("\xabKTX 20\xbb\r\n\x1a\n");
    out.word(vulkanFormat(format));
    out.word(format == TexelFormat::rgba16f ? 2 : 1); // bytes of a number
    out.word(uint32_t(finest.width));
    out.word(uint32_t(finest.height));
    out.word(0); // depth
    out.word(0); // layers
    out.word(1); // faces
    out.word(levels);
    out.word(zstandard ? 2 : 0);
    out.word(dfdAt);
    out.word(uint32_t(dfd.size()));
    out.word(dfdAt + uint32_t(dfd.size()));
    out.word(uint32_t(pairs.size()));
    out.longWord(0); // supercompression has no global data
    out.longWord(0);
    for (uint32_t i = 0; i < 3 * levels; ++i)
        out.longWord(0); // the level index, filled in below
    out.add(dfd);
    out.add(pairs);
    // The smallest level comes first in the file, so that it can be shown first.
    for (size_t l = levels; l-- > 0;) {
        const std::vector<std::byte> texels = encodeTexels(map.levels[l], format);
        if (!zstandard)
            out.padTo(std::max<size_t>(4, size_t(layoutOf(format).blockBytes)));
        const size_t at = kHeaderBytes + kLevelBytes * l, start = out.size();
        out.add(zstandard ? supercompressed(texels) : texels);
        out.setLongWord(at, start);
        out.setLongWord(at + 8, out.size() - start);
        out.setLongWord(at + 16, texels.size());
    }
    return out.take();
}

} // namespace lumel::baker
