// EXT_meshopt_compression: buffer views packed by meshoptimizer's codecs.
#include "compression.h"
#include "core/error.h"
#include <fmt/format.h>
#include <meshoptimizer.h>

namespace lumel::scene {
namespace {

using Json = nlohmann::json;

// The codecs spend at least so much on an element: anything shorter is refused before memory is taken.
// Vertices: 2 bits for 16 bytes of each byte plane. Triangles and index sequences: a byte each.
constexpr size_t kMaxVertexRatio = 64;

enum class Mode { attributes, triangles, indices };

bool unpack(Mode mode, std::vector<std::byte>& out, size_t count, size_t stride,
            std::span<const std::byte> packed)
{
    const auto* bytes = reinterpret_cast<const unsigned char*>(packed.data());
    switch (mode) {
    case Mode::attributes:
        return meshopt_decodeVertexBuffer(out.data(), count, stride, bytes, packed.size()) == 0;
    case Mode::triangles:
        return meshopt_decodeIndexBuffer(out.data(), count, stride, bytes, packed.size()) == 0;
    case Mode::indices:
        return meshopt_decodeIndexSequence(out.data(), count, stride, bytes, packed.size()) == 0;
    }
    return false;
}

// False for a filter that is unknown or does not suit the stride, which the library would only assert.
bool applyFilter(const std::string& filter, std::vector<std::byte>& out, size_t count, size_t stride)
{
    if (filter == "NONE")
        return true;
    if (filter == "OCTAHEDRAL" && (stride == 4 || stride == 8))
        meshopt_decodeFilterOct(out.data(), count, stride);
    else if (filter == "QUATERNION" && stride == 8)
        meshopt_decodeFilterQuat(out.data(), count, stride);
    else if (filter == "EXPONENTIAL" && stride % 4 == 0)
        meshopt_decodeFilterExp(out.data(), count, stride);
    else
        return false;
    return true;
}

// What the extension's specification demands of stride and count; the library asserts it.
bool suits(Mode mode, size_t count, size_t stride, size_t packed)
{
    if (count == 0)
        return false;
    if (mode == Mode::attributes)
        return stride > 0 && stride % 4 == 0 && stride <= 256 && count * stride <= packed * kMaxVertexRatio;
    if (mode == Mode::triangles)
        return (stride == 2 || stride == 4) && count % 3 == 0 && count / 3 <= packed;
    return (stride == 2 || stride == 4) && count <= packed;
}

} // namespace

void CompressedDocument::expandView(Json& view, const Json& extension, const std::string& where)
{
    const auto text = [&](const char* key, const char* otherwise) {
        const auto found = extension.find(key);
        return found != extension.end() && found->is_string() ? found->get<std::string>()
                                                              : std::string(otherwise);
    };
    const std::string modeName = text("mode", "");
    const Mode mode = modeName == "TRIANGLES" ? Mode::triangles
                      : modeName == "INDICES" ? Mode::indices
                                              : Mode::attributes;
    if (mode == Mode::attributes && modeName != "ATTRIBUTES")
        fail(fmt::format("{} has the unknown compression mode '{:.32}'", where, modeName));
    const size_t count = number(extension, "count", where), stride = number(extension, "byteStride", where);
    const auto packed = range(number(extension, "buffer", where),
                              extension.contains("byteOffset") ? number(extension, "byteOffset", where) : 0,
                              number(extension, "byteLength", where), where);
    if (!suits(mode, count, stride, packed.size()))
        fail(fmt::format("{} cannot hold {} elements of {} bytes in {} compressed ones", where, count, stride,
                         packed.size()));
    std::vector<std::byte> bytes = allocate(count * stride);
    if (!unpack(mode, bytes, count, stride, packed))
        fail(fmt::format("{} holds damaged EXT_meshopt_compression data", where));
    const std::string filter = text("filter", "NONE");
    if (mode == Mode::attributes ? !applyFilter(filter, bytes, count, stride) : filter != "NONE")
        fail(fmt::format("{} has a compression filter '{:.32}' that does not suit it", where, filter));
    view = {{"byteLength", bytes.size()}};
    if (mode == Mode::attributes)
        view["byteStride"] = stride;
    view["buffer"] = addBuffer(std::move(bytes));
}

void CompressedDocument::expandMeshopt()
{
    const auto views = root_.find("bufferViews");
    if (views == root_.end() || !views->is_array())
        return;
    for (size_t i = 0; i < views->size(); ++i) {
        Json& view = (*views)[i];
        const auto pointer = Json::json_pointer("/extensions/EXT_meshopt_compression");
        if (!view.is_object() || !view.contains(pointer))
            continue;
        const Json extension = view[pointer]; // a copy: the view is replaced
        expandView(view, extension, fmt::format("buffer view {}", i));
    }
}

} // namespace lumel::scene
