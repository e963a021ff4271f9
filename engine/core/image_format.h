// Which of the image formats that we read a file holds, told by its content, never by its name.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace lumel {

enum class ImageFormat : uint32_t { png, jpeg, webp, exr, hdr, tiff, tga, none };

// A set of formats, one bit each.
using ImageFormats = uint32_t;
constexpr ImageFormats formatBit(ImageFormat format)
{
    return 1u << uint32_t(format);
}
inline constexpr ImageFormats kAllImageFormats = formatBit(ImageFormat::none) - 1;
// glTF 2.0, section 5.18, and EXT_texture_webp.
inline constexpr ImageFormats kGltfImageFormats =
    formatBit(ImageFormat::png) | formatBit(ImageFormat::jpeg) | formatBit(ImageFormat::webp);

// By the magic number at the start. TGA has none: a valid header and either the footer of version 2 or, as
// `namedTga` says, the ending of the file's name make one.
ImageFormat imageFormat(std::span<const std::byte> bytes, bool namedTga);

// "PNG, JPEG or WebP"
std::string formatNames(ImageFormats formats);

} // namespace lumel
