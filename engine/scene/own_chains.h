// Chains that a model brings, written by `lumel bake model.glb`.
//
// One counts in place of its material's maps as long as these are what it was baked from, and no option that
// was given asks for another bake. A chain that the command line names for a material always counts.
#pragma once
#include "materials.h"
#include <span>

namespace lumel::scene {

std::string imageHash(std::span<const std::byte> encoded);

// Of all that a material's reflectance depends on: its factors, and the encoded images by their hashes.
// Written to files: what Material gets later must not change it at its default.
std::string mapsHash(const Material& material, std::span<const std::string> imageHashes);

// For each material the chain to read, empty where its maps are to be baked. One line says which of a
// model's own chains do not count and why. Throws Error for files that are no chains.
std::vector<std::filesystem::path> chainsToRead(const Scene& scene, const MaterialOptions& options,
                                                std::span<const std::string> imageHashes);

} // namespace lumel::scene
