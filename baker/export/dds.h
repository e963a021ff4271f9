// DDS (Microsoft, "Programming Guide for DDS").
#pragma once
#include "texels.h"

namespace lumel::baker {

std::vector<std::byte> encodeDds(const ExportMap& map, TexelStorage storage,
                                 DdsHeader header = DdsHeader::dx10);

} // namespace lumel::baker
