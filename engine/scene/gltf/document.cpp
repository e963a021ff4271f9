#include "document.h"
#include "compression.h"
#include "core/error.h"
#include "core/file.h"
#include "limits.h"
#include "uri.h"
#include <array>
#include <cstring>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>

namespace lumel::scene {
namespace {

using Json = nlohmann::json;

// KHR_texture_basisu is among them although nothing decodes it: such textures become neutral.
constexpr std::array kSupportedExtensions = {
    "KHR_lights_punctual",        "KHR_materials_emissive_strength",
    "KHR_materials_ior",          "KHR_materials_specular",
    "KHR_materials_anisotropy",   "KHR_materials_unlit",
    "KHR_mesh_quantization",      "KHR_materials_pbrSpecularGlossiness",
    "KHR_draco_mesh_compression", "KHR_texture_basisu",
    "EXT_meshopt_compression",    "EXT_mesh_gpu_instancing",
    "EXT_texture_webp",           "KHR_texture_transform"};

bool supported(const std::string& extension)
{
    return std::find(kSupportedExtensions.begin(), kSupportedExtensions.end(), extension) !=
           kSupportedExtensions.end();
}

class DocumentReader {
public:
    explicit DocumentReader(const std::filesystem::path& file) : path_(file)
    {
        document_.file = file.string();
    }

    Document read()
    {
        const std::vector<std::byte> bytes = readFile(path_);
        if (bytes.empty())
            fail("empty file (0 bytes)");
        std::span<const std::byte> text = bytes;
        if (bytes.size() >= 4 && std::memcmp(bytes.data(), "glTF", 4) == 0)
            text = splitBinary(bytes);
        else if (path_.extension() == ".glb")
            fail("not a binary glTF file", "name a .glb that a 3D program exported");
        checkShape(text);
        parse(text);
        checkVersion();
        checkExtensions();
        readBuffers();
        readImages();
        CompressedDocument compressed(root_, document_, [this](size_t bytes) { count(bytes); });
        compressed.expandMeshopt();
        compressed.expandDraco();
        dropUndrawn();
        document_.json = root_.dump();
        return std::move(document_);
    }

private:
    [[noreturn]] void fail(const std::string& why, const char* remedy = "export it again") const
    {
        throw Error(fmt::format("{}: {}; {}", document_.file, why, remedy));
    }

    std::span<const std::byte> splitBinary(std::span<const std::byte> bytes);
    void checkShape(std::span<const std::byte> text) const;
    void parse(std::span<const std::byte> text);
    void checkVersion() const;
    void checkExtensions();
    void readBuffers();
    void readImages();
    void dropUndrawn();
    std::vector<std::byte> bytesOfUri(const std::string& uri, std::string& name);
    void count(size_t bytes);
    // The array `key` of the root, empty when absent. Throws when it is something else or when an
    // element is no object.
    std::vector<const Json*> objects(const char* key) const;

    std::filesystem::path path_;
    Document document_;
    Json root_;
    std::optional<std::span<const std::byte>> binaryChunk_;
    size_t totalBytes_ = 0;
};

// glTF 2.0, section 4.4: a header of magic, version and length, then chunks of length, type and data.
// All sums are of 32-bit values in 64 bits: nothing wraps.
std::span<const std::byte> DocumentReader::splitBinary(std::span<const std::byte> bytes)
{
    const auto word = [&](size_t at) {
        uint32_t value;
        std::memcpy(&value, bytes.data() + at, 4);
        return size_t(value); // glTF is little-endian, and so is every machine with Vulkan
    };
    if (bytes.size() < 20)
        fail("truncated binary glTF", "copy the file again");
    if (word(4) != 2)
        fail(fmt::format("binary glTF of version {}", word(4)), "export it as glTF 2.0");
    const size_t end = word(8);
    if (end > bytes.size())
        fail(fmt::format("truncated: it declares {} bytes and holds {}", end, bytes.size()),
             "copy the file again");
    std::optional<std::span<const std::byte>> json;
    for (size_t at = 12; at + 8 <= end;) {
        const size_t length = word(at);
        if (length > end - at - 8)
            fail(fmt::format("a chunk of {} bytes exceeds the file", length), "copy the file again");
        const auto chunk = bytes.subspan(at + 8, length);
        if (!json && word(at + 4) == 0x4e4f534a) // "JSON"
            json = chunk;
        else if (json && !binaryChunk_ && word(at + 4) == 0x004e4942) // "BIN"
            binaryChunk_ = chunk;
        else if (!json)
            fail("the first chunk of the binary glTF is not JSON");
        at += 8 + length; // chunks are padded to 4 bytes by the writer
    }
    if (!json)
        fail("binary glTF without a JSON chunk");
    return *json;
}

// One pass over the raw text, so that neither parser recurses or allocates without bound.
void DocumentReader::checkShape(std::span<const std::byte> text) const
{
    if (text.size() > kMaxJsonBytes)
        fail("more than 2 GiB of JSON", "keep buffers and images in files of their own");
    size_t depth = 0, values = 0;
    bool inString = false;
    for (size_t i = 0; i < text.size(); ++i) {
        const char c = char(text[i]);
        if (inString) {
            if (c == '\\')
                ++i;
            else if (c == '"')
                inString = false;
            continue;
        }
        inString = c == '"';
        if (c == '{' || c == '[')
            ++depth, ++values;
        else if ((c == '}' || c == ']') && depth > 0)
            --depth;
        else if (c == ',')
            ++values;
        if (depth > kMaxNesting)
            fail(fmt::format("JSON nested deeper than {} levels", kMaxNesting));
        if (values > kMaxJsonValues)
            fail(fmt::format("JSON of more than {} values", kMaxJsonValues));
    }
}

void DocumentReader::parse(std::span<const std::byte> text)
{
    const char* begin = reinterpret_cast<const char*>(text.data());
    const char* end = begin + text.size();
    while (end > begin && (end[-1] == '\0' || end[-1] == ' ')) // padding of the GLB chunk
        --end;
    try {
        root_ = Json::parse(begin, end);
    } catch (const Json::parse_error& e) {
        const char* at = begin + std::min<size_t>(e.byte, size_t(end - begin));
        fail(fmt::format("not glTF: invalid JSON in line {}", 1 + std::count(begin, at, '\n')),
             "name a .gltf or .glb file");
    } catch (const Json::exception&) { // a number beyond double
        fail("a number in it is out of range");
    }
    if (!root_.is_object())
        fail("not glTF: the JSON is not an object", "name a .gltf or .glb file");
}

void DocumentReader::checkVersion() const
{
    const auto asset = root_.find("asset");
    if (asset == root_.end() || !asset->is_object() || !asset->contains("version") ||
        !(*asset)["version"].is_string())
        fail("not glTF: asset.version is missing", "name a .gltf or .glb file");
    const std::string version = (*asset)["version"];
    if (version.rfind("2.", 0) != 0)
        fail(fmt::format("glTF of version {:.8}", printable(version)), "export it as glTF 2.0");
}

void DocumentReader::checkExtensions()
{
    const auto names = [&](const char* key) {
        std::vector<std::string> list;
        const auto array = root_.find(key);
        if (array == root_.end())
            return list;
        if (!array->is_array())
            fail(fmt::format("{} is not an array", key));
        for (const Json& name : *array) {
            if (!name.is_string())
                fail(fmt::format("{} must hold names only", key));
            list.push_back(name);
        }
        return list;
    };
    for (const std::string& name : names("extensionsRequired"))
        if (!supported(name))
            fail(fmt::format("requires the extension {:.64}, which is not supported", printable(name)),
                 "export it without");
    for (const std::string& name : names("extensionsUsed")) {
        document_.quantised |= name == "KHR_mesh_quantization";
        if (!supported(name))
            document_.ignored.insert(printable(name).substr(0, 64));
    }
}

std::vector<const Json*> DocumentReader::objects(const char* key) const
{
    std::vector<const Json*> list;
    const auto array = root_.find(key);
    if (array == root_.end())
        return list;
    if (!array->is_array())
        fail(fmt::format("{} is not an array", key));
    for (const Json& element : *array) {
        if (!element.is_object())
            fail(fmt::format("{} must hold objects only", key));
        list.push_back(&element);
    }
    return list;
}

void DocumentReader::count(size_t bytes)
{
    if (bytes > kMaxTotalBytes - totalBytes_)
        fail("buffers and images exceed 4 GiB", "split the model");
    totalBytes_ += bytes;
}

std::vector<std::byte> DocumentReader::bytesOfUri(const std::string& uri, std::string& name)
{
    std::vector<std::byte> bytes;
    if (isDataUri(uri)) {
        bytes = decodeDataUri(document_.file, uri);
    } else {
        const auto file = resolveUri(document_.file, path_.parent_path(), uri);
        name = file.string();
        try {
            bytes = readFile(file, kMaxTotalBytes - totalBytes_);
        } catch (const Error& e) {
            throw Error(fmt::format("{}: {}", document_.file, e.what()));
        }
    }
    count(bytes.size());
    return bytes;
}

void DocumentReader::readBuffers()
{
    for (const Json* buffer : objects("buffers")) {
        const size_t index = document_.buffers.size();
        const auto length = buffer->find("byteLength");
        if (length == buffer->end() || !length->is_number_unsigned() || *length == 0u)
            fail(fmt::format("buffer {} has no byteLength", index));
        const size_t wanted = *length;
        std::string name = fmt::format("buffer {}", index);
        std::vector<std::byte> bytes;
        if (buffer->value(Json::json_pointer("/extensions/EXT_meshopt_compression/fallback"), Json()) ==
            true) {
            document_.buffers.emplace_back(); // its views are unpacked from elsewhere
            continue;
        }
        if (const auto uri = buffer->find("uri"); uri != buffer->end()) {
            if (!uri->is_string())
                fail(fmt::format("buffer {} has a URI that is not a string", index));
            bytes = bytesOfUri(*uri, name);
        } else if (index == 0 && binaryChunk_) {
            bytes.assign(binaryChunk_->begin(), binaryChunk_->end());
            count(bytes.size());
        } else {
            fail(fmt::format("buffer {} names no data", index));
        }
        if (bytes.size() < wanted)
            fail(fmt::format("{} holds {} of {} bytes", name, bytes.size(), wanted), "copy the file again");
        bytes.resize(wanted); // files and chunks may be padded
        document_.buffers.push_back(std::move(bytes));
    }
    root_.erase("buffers");
}

void DocumentReader::readImages()
{
    for (const Json* image : objects("images")) {
        ImageSource source;
        source.name = fmt::format("{}#image{}", document_.file, document_.images.size());
        const auto uri = image->find("uri");
        const auto view = image->find("bufferView");
        if (uri != image->end() && uri->is_string())
            source.bytes = bytesOfUri(*uri, source.name);
        else if (view != image->end() && view->is_number_unsigned() && view->get<uint64_t>() < (1u << 31))
            source.bufferView = *view;
        else
            fail(fmt::format("image {} has neither a URI nor a buffer view", document_.images.size()));
        document_.images.push_back(std::move(source));
    }
    root_.erase("images");
}

void DocumentReader::dropUndrawn()
{
    // Without inverse bind matrices they are identities; tinygltf wants a number all the same.
    if (root_.contains("skins") && root_["skins"].is_array())
        for (Json& skin : root_["skins"])
            if (skin.is_object() && !skin.contains("inverseBindMatrices"))
                skin["inverseBindMatrices"] = -1;
    // glTF 2.0, section 3.11: a channel without a node moves something that only an extension knows.
    if (!root_.contains("animations") || !root_["animations"].is_array())
        return;
    for (Json& animation : root_["animations"]) {
        if (!animation.is_object() || !animation.contains("channels") || !animation["channels"].is_array())
            fail("an animation has no channels");
        Json& channels = animation["channels"];
        channels.erase(std::remove_if(channels.begin(), channels.end(),
                                      [](const Json& channel) {
                                          return channel.is_object() && channel.contains("target") &&
                                                 channel["target"].is_object() &&
                                                 !channel["target"].contains("node");
                                      }),
                       channels.end());
    }
}

} // namespace

std::string printable(std::string text)
{
    for (char& c : text)
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
            c = '?';
    return text;
}

Document readDocument(const std::filesystem::path& file)
{
    return DocumentReader(file).read();
}

} // namespace lumel::scene
