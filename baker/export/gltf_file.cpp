#include "gltf_file.h"
#include "byte_writer.h"
#include "core/error.h"
#include "core/file.h"
#include <fmt/format.h>

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

GltfFile readGltfFile(const std::filesystem::path& path)
{
    const std::vector<std::byte> bytes = readFile(path);
    std::span<const std::byte> text = bytes;
    GltfFile file;
    if (bytes.size() >= 20 && std::memcmp(bytes.data(), "glTF", 4) == 0) {
        const auto chunk = [&](size_t at) { // its data; empty beyond the end
            uint32_t length = 0;
            if (at + 8 <= bytes.size())
                std::memcpy(&length, &bytes[at], sizeof length);
            return std::span(bytes).subspan(
                std::min(at + 8, bytes.size()),
                std::min<size_t>(length, bytes.size() - std::min(at + 8, bytes.size())));
        };
        text = chunk(12);
        const auto binary = chunk(20 + text.size());
        file.binary.assign(binary.begin(), binary.end());
    }
    const auto* begin = reinterpret_cast<const char*>(text.data());
    file.json = GltfJson::parse(begin, begin + text.size(), nullptr, false);
    if (!file.json.is_object())
        throw Error(fmt::format("{}: not glTF; name a .gltf or .glb file", path.string()));
    return file;
}

} // namespace lumel::baker
