// KTX 2.0 (Khronos, "KTX File Format Specification") with its Data Format Descriptor (Khronos Data Format
// Specification 1.3).
#pragma once
#include "texels.h"

namespace lumel::baker {

// `zstandard`: levels are supercompressed, each on its own.
std::vector<std::byte> encodeKtx2(const ExportMap& map, TexelStorage storage, bool zstandard);

} // namespace lumel::baker
