// Takes out of a model what exchanged textures leave without use.
#pragma once
#include "gltf_file.h"
#include <set>

namespace lumel::baker {

// How many a model had before anything was added.
struct GltfCounts {
    explicit GltfCounts(const GltfJson& json);
    size_t textures, images, views;
};

// Removes those of `replaced` textures that nothing refers to any more, their images, and the images' bytes
// in the binary chunk. What was added since takes their places, so that no other index changes. What is not
// understood counts as a reference.
void dropUnused(GltfFile& file, const GltfCounts& before, const std::set<size_t>& replaced);

} // namespace lumel::baker
