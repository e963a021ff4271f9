#include "gltf_file.h"
#include "byte_writer.h"

namespace lumel::baker {

size_t GltfFile::add(const char* key, GltfJson element)
{
    GltfJson& array = json[key];
    array.push_back(std::move(element));
    return array.size() - 1;
}

size_t GltfFile::addView(std::span<const std::byte> bytes)
{
    binary.resize((binary.size() + 3) / 4 * 4);
    const size_t start = binary.size();
    binary.insert(binary.end(), bytes.begin(), bytes.end());
    if (!json.contains("buffers") || json["buffers"].empty())
        json["buffers"] = GltfJson::array({GltfJson::object()});
    json["buffers"][0]["byteLength"] = binary.size();
    return add("bufferViews", {{"buffer", 0}, {"byteOffset", start}, {"byteLength", bytes.size()}});
}

size_t GltfFile::addPng(const std::string& name, std::span<const unsigned char> png)
{
    const size_t view = addView(std::as_bytes(png));
    return add("images", {{"name", name}, {"mimeType", "image/png"}, {"bufferView", view}});
}

// glTF 2.0, section 4.4.
std::vector<std::byte> GltfFile::glb() const
{
    ByteWriter text, chunk, out;
    text.text(json.dump());
    text.padTo(4, std::byte(' '));
    chunk.add(binary);
    chunk.padTo(4);
    const auto jsonBytes = text.take(), binaryBytes = chunk.take();
    const size_t length = 12 + 8 + jsonBytes.size() + (binaryBytes.empty() ? 0 : 8 + binaryBytes.size());
    out.text("glTF");
    out.word(2);
    out.word(uint32_t(length));
    out.word(uint32_t(jsonBytes.size()));
    out.text("JSON");
    out.add(jsonBytes);
    if (!binaryBytes.empty()) {
        out.word(uint32_t(binaryBytes.size()));
        out.text(std::string("BIN\0", 4));
        out.add(binaryBytes);
    }
    return out.take();
}

} // namespace lumel::baker
