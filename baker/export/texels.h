// Pictures as the texels of GPU formats.
#pragma once
#include "maps.h"
#include <cstddef>

namespace lumel::baker {

// Bits of a texel: 8 a channel, block-compressed where a format suits the map, or half floats.
enum class TexelStorage { bytes, blocks, halves };

// Headers of DDS files: DX10 names any format; that of DirectX 9, which older programs want, does not tell
// sRGB.
enum class DdsHeader { dx10, dx9 };

enum class TexelFormat { r8, rgba8, rgba8Srgb, rgba16f, bc4, bc5 };

// The format that holds a map: one channel in R8 or BC4, normals in BC5 (x and y), all else in four channels.
TexelFormat formatOf(const ExportMap& map, TexelStorage storage);

struct TexelLayout {
    int blockSide; // texels
    int blockBytes;
};
TexelLayout layoutOf(TexelFormat format);
size_t bytesOfLevel(TexelFormat format, int width, int height);

// Rows from the top; blocks at the border repeat its last texels. A missing alpha is 1.
std::vector<std::byte> encodeTexels(const Image& image, TexelFormat format);

} // namespace lumel::baker
