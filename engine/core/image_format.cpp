#include "image_format.h"
#include <array>
#include <string_view>
#include <vector>

namespace lumel {
namespace {

using namespace std::string_view_literals;

struct Magic {
    std::string_view bytes;
    ImageFormat format;
};
constexpr std::array kMagics = {
    Magic{"\x89PNG\r\n\x1a\n"sv, ImageFormat::png}, // RFC 2083, section 3.1
    Magic{"\xff\xd8\xff"sv, ImageFormat::jpeg},     // start of image, and the next marker's first byte
    Magic{"\x76\x2f\x31\x01"sv, ImageFormat::exr},
    Magic{"#?RADIANCE"sv, ImageFormat::hdr},
    Magic{"#?RGBE"sv, ImageFormat::hdr},
    Magic{"II*\0"sv, ImageFormat::tiff}, // TIFF 6.0, section 2: little-endian, then big-endian
    Magic{"MM\0*"sv, ImageFormat::tiff},
    Magic{"II+\0"sv, ImageFormat::tiff}, // BigTIFF
    Magic{"MM\0+"sv, ImageFormat::tiff},
};

// Truevision TGA File Format Specification 2.0.
bool hasTgaHeader(std::string_view text)
{
    constexpr size_t kHeaderBytes = 18;
    if (text.size() < kHeaderBytes)
        return false;
    const auto byte = [&](size_t at) { return unsigned(uint8_t(text[at])); };
    const auto word = [&](size_t at) { return byte(at) + 256 * byte(at + 1); };
    const unsigned paletted = byte(1), type = byte(2) & ~8u, depth = byte(16); // 8: run lengths
    const bool typeIsKnown = (byte(2) & ~11u) == 0 && type >= 1;               // 1 to 3 and 9 to 11
    const bool paletteFits = type == 1 ? paletted == 1 && word(5) > 0 : paletted <= 1;
    const bool depthIsKnown = depth == 8 || depth == 15 || depth == 16 || depth == 24 || depth == 32;
    const bool notInterleaved = (byte(17) & 0xc0) == 0; // always 0 in version 2
    return typeIsKnown && paletteFits && depthIsKnown && notInterleaved && word(12) > 0 && word(14) > 0;
}

bool hasTgaFooter(std::string_view text)
{
    return text.ends_with("TRUEVISION-XFILE.\0"sv);
}

} // namespace

ImageFormat imageFormat(std::span<const std::byte> bytes, bool namedTga)
{
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    for (const Magic& magic : kMagics)
        if (text.starts_with(magic.bytes))
            return magic.format;
    if (text.starts_with("RIFF"sv) && text.size() >= 12 && text.substr(8, 4) == "WEBP"sv)
        return ImageFormat::webp;
    if ((namedTga || hasTgaFooter(text)) && hasTgaHeader(text))
        return ImageFormat::tga;
    return ImageFormat::none;
}

std::string formatNames(ImageFormats formats)
{
    constexpr std::array kNames = {"PNG", "JPEG", "WebP", "EXR", "HDR", "TIFF", "TGA"};
    std::vector<std::string> names;
    for (uint32_t i = 0; i < kNames.size(); ++i)
        if (formats >> i & 1)
            names.emplace_back(kNames[i]);
    std::string text;
    for (size_t i = 0; i < names.size(); ++i)
        text += (i == 0 ? "" : i + 1 == names.size() ? " or " : ", ") + names[i];
    return text;
}

} // namespace lumel
