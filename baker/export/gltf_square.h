// A material on a square, one unit wide: what a glTF viewer can show of exported maps.
#pragma once
#include "maps.h"
#include "staged_files.h"
#include <nlohmann/json.hpp>

namespace lumel::baker {

// Writes NAME.gltf with its buffer and PNG files, or NAME.glb with all in one. The maps must be packed for
// glTF. Returns the names of the files.
nlohmann::json writeGltfSquare(const std::string& name, const std::vector<ExportMap>& maps, bool binary,
                               StagedFiles& files);

} // namespace lumel::baker
