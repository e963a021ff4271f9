// A glTF 2.0 file as its JSON and its binary chunk, for writers that leave what they do not know as it is.
#pragma once
#include <cstddef>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

namespace lumel::baker {

// Keeps the order of members.
using GltfJson = nlohmann::ordered_json;

struct GltfFile {
    GltfJson json;
    std::vector<std::byte> binary; // of buffer 0, which has no URI; empty: none

    // Index of a new buffer view of `binary`, aligned to 4 bytes.
    size_t addView(std::span<const std::byte> bytes);
    // Index of a new image, in a buffer view.
    size_t addPng(const std::string& name, std::span<const unsigned char> png);
    // Adds to the array `key` of the root; returns its index.
    size_t add(const char* key, GltfJson element);

    std::vector<std::byte> glb() const;
};

// A .gltf or .glb that another reader has found to be sound; other buffers and images stay where they are.
// Throws Error.
GltfFile readGltfFile(const std::filesystem::path& file);

} // namespace lumel::baker
