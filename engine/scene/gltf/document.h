// A glTF file before its meaning is read: the container, the JSON text and all bytes it refers to.
//
// tinygltf gets only JSON, cleaned of buffers, images and everything that is not drawn yet. It therefore
// never opens a file, decodes base64 or touches a GLB header, which is where such loaders have had
// their security bugs (URI traversal, shell expansion, GLB length wrap, recursion on deep nesting).
#pragma once
#include <cstddef>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace lumel::scene {

// An image stays encoded. Exactly one of bytes and bufferView is given.
struct ImageSource {
    std::string name; // for messages
    std::vector<std::byte> bytes;
    int bufferView = -1;
};

struct Document {
    std::string file;                            // as the user named it: every message begins with it
    std::string json;                            // valid, of limited depth and size
    std::vector<std::vector<std::byte>> buffers; // each exactly byteLength long
    std::vector<ImageSource> images;
    bool quantised = false;        // KHR_mesh_quantization: attributes may be integers
    std::set<std::string> ignored; // optional extensions and features that are present and not drawn
};

// Names come from the file: control characters would break one-line messages or command a terminal.
std::string printable(std::string text);

// Reads the file and all it refers to. Throws Error.
Document readDocument(const std::filesystem::path& file);

} // namespace lumel::scene
