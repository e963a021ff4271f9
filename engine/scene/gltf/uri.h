// URIs in glTF files: what they may name, and the bytes of data: URIs.
#pragma once
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace lumel::scene {

bool isDataUri(const std::string& uri);

// Bytes of "data:<type>;base64,<text>" or percent-encoded text (RFC 2397). `model` names the glTF file in
// messages. Throws Error.
std::vector<std::byte> decodeDataUri(const std::string& model, const std::string& uri);

// The file that a relative URI (RFC 3986, percent-encoded) names in `folder`. Throws Error for whatever
// could leave the folder: schemes, absolute paths, `..`, links that lead out of it.
std::filesystem::path resolveUri(const std::string& model, const std::filesystem::path& folder,
                                 const std::string& uri);

} // namespace lumel::scene
