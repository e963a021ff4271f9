#include "compression.h"
#include "core/error.h"
#include <fmt/format.h>

namespace lumel::scene {

using Json = nlohmann::json;

void CompressedDocument::fail(const std::string& why) const
{
    throw Error(fmt::format("{}: {}; export it again", document_.file, printable(why)));
}

size_t CompressedDocument::number(const Json& extension, const char* key, const std::string& where) const
{
    const auto found = extension.is_object() ? extension.find(key) : extension.end();
    if (found == extension.end() || !found->is_number_unsigned() || found->get<uint64_t>() > UINT32_MAX)
        fail(fmt::format("{} is compressed without a usable {}", where, key));
    return found->get<size_t>();
}

std::span<const std::byte> CompressedDocument::range(size_t buffer, size_t offset, size_t length,
                                                     const std::string& where) const
{
    if (buffer >= document_.buffers.size())
        fail(fmt::format("{}: buffer {} does not exist", where, buffer));
    const std::span<const std::byte> bytes = document_.buffers[buffer];
    if (offset > bytes.size() || length > bytes.size() - offset)
        fail(fmt::format("{} reads past the end of its buffer", where));
    return bytes.subspan(offset, length);
}

std::span<const std::byte> CompressedDocument::viewBytes(size_t index, const std::string& where) const
{
    const auto views = root_.find("bufferViews");
    if (views == root_.end() || !views->is_array() || index >= views->size())
        fail(fmt::format("{}: buffer view {} does not exist", where, index));
    const Json& view = (*views)[index];
    const std::string name = fmt::format("buffer view {}", index);
    const bool atStart = !view.is_object() || !view.contains("byteOffset");
    return range(number(view, "buffer", name), atStart ? 0 : number(view, "byteOffset", name),
                 number(view, "byteLength", name), name);
}

std::vector<std::byte> CompressedDocument::allocate(size_t bytes) const
{
    count_(bytes);
    return std::vector<std::byte>(bytes);
}

size_t CompressedDocument::addBuffer(std::vector<std::byte> bytes)
{
    document_.buffers.push_back(std::move(bytes));
    return document_.buffers.size() - 1;
}

size_t CompressedDocument::addAccessor(Json accessor, std::vector<std::byte> bytes)
{
    const size_t length = bytes.size();
    root_["bufferViews"].push_back({{"buffer", addBuffer(std::move(bytes))}, {"byteLength", length}});
    accessor["bufferView"] = root_["bufferViews"].size() - 1;
    root_["accessors"].push_back(std::move(accessor));
    return root_["accessors"].size() - 1;
}

} // namespace lumel::scene
