// The glTF 2.0 reader: what each extension becomes, see README.md beside this file.
#pragma once
#include "scene/scene.h"

namespace lumel::scene {

// Loads .gltf (with files beside it or embedded) or .glb. Throws Error, one line naming file and remedy,
// for anything malformed. Logs one line per object that cannot be lit in texture space.
Scene loadGltf(const std::filesystem::path& file);

// Its images and all of its materials, in the file's order, whether meshes use them or not; nothing else.
Scene loadMaterials(const std::filesystem::path& file);

} // namespace lumel::scene
