// DDS with the DX10 header (Microsoft, "Programming Guide for DDS").
#pragma once
#include "texels.h"

namespace lumel::baker {

std::vector<std::byte> encodeDds(const ExportMap& map, TexelStorage storage);

} // namespace lumel::baker
