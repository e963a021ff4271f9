// Steps of an export, which whole models share.
#pragma once
#include "export.h"
#include <nlohmann/json.hpp>

namespace lumel::baker {

// Adds what was written to description["maps"].
void writeMaps(const std::string& name, const std::vector<ExportMap>& maps, const ExportOptions& options,
               StagedFiles& files, nlohmann::json& description);
nlohmann::json describeLevels(const std::vector<GgxLevel>& levels);
// The first level of a map as an 8-bit PNG.
std::vector<unsigned char> pngOf(const ExportMap& map);

} // namespace lumel::baker
