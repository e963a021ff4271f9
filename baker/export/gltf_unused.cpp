#include "gltf_unused.h"
#include <functional>
#include <optional>
#include <utility>

namespace lumel::baker {
namespace {

size_t countOf(const GltfJson& json, const char* key)
{
    return json.contains(key) ? json[key].size() : 0;
}

// Calls visit(object) for every object of a document.
void forObjects(GltfJson& json, const std::function<void(GltfJson&)>& visit)
{
    if (json.is_object())
        visit(json);
    if (json.is_structured())
        for (GltfJson& child : json)
            forObjects(child, visit);
}

bool isNumber(const GltfJson& object, const char* key, size_t value)
{
    return object.contains(key) && object[key].is_number_integer() && object[key] == value;
}

bool isReferred(GltfFile& file, std::initializer_list<const char*> keys, size_t value)
{
    bool found = false;
    forObjects(file.json, [&](const GltfJson& object) {
        for (const char* key : keys)
            found |= isNumber(object, key, value);
    });
    return found;
}

// Removes element `index` of an array of the root. The last one, if it was added, takes its place, and
// references to that follow: `key` in the objects of `users`. Returns what was removed; nothing, and all
// stays, if no element was added.
std::optional<GltfJson> remove(GltfFile& file, const char* name, size_t index, size_t before,
                               const char* users, const char* key)
{
    GltfJson& array = file.json[name];
    const size_t last = array.size() - 1;
    if (last < before)
        return std::nullopt;
    GltfJson removed = std::exchange(array[index], std::move(array[last]));
    array.erase(last);
    forObjects(file.json[users], [&](GltfJson& object) {
        if (isNumber(object, key, last))
            object[key] = index;
    });
    return removed;
}

size_t at(const GltfJson& object, const char* key)
{
    return object.value(key, size_t(0));
}

// Cuts the bytes of a view that no other overlaps, and moves all that follow. Steps of 16 bytes keep whatever
// alignment there is.
void cut(GltfFile& file, size_t begin, size_t length)
{
    const size_t end = begin + length;
    const size_t bytes = length / 16 * 16;
    bool isShared = false;
    const auto ofBinary = [](const GltfJson& object) {
        return isNumber(object, "buffer", 0) && object.contains("byteLength");
    };
    forObjects(file.json, [&](GltfJson& object) {
        isShared |= ofBinary(object) && at(object, "byteOffset") < end &&
                    at(object, "byteOffset") + at(object, "byteLength") > begin;
    });
    if (isShared || end > file.binary.size())
        return;
    file.binary.erase(file.binary.begin() + std::ptrdiff_t(begin),
                      file.binary.begin() + std::ptrdiff_t(begin + bytes));
    forObjects(file.json, [&](GltfJson& object) {
        if (ofBinary(object) && at(object, "byteOffset") >= end)
            object["byteOffset"] = at(object, "byteOffset") - bytes;
    });
    file.json["buffers"][0]["byteLength"] = file.binary.size();
}

void dropImage(GltfFile& file, size_t image, const GltfCounts& before)
{
    const auto removed = remove(file, "images", image, before.images, "textures", "source");
    if (!removed || !removed->contains("bufferView"))
        return;
    const size_t view = (*removed)["bufferView"];
    const bool isOurs = !file.binary.empty() && isNumber(file.json["bufferViews"][view], "buffer", 0);
    if (!isOurs || isReferred(file, {"bufferView"}, view))
        return;
    if (const auto bytes = remove(file, "bufferViews", view, before.views, "images", "bufferView"))
        cut(file, at(*bytes, "byteOffset"), at(*bytes, "byteLength"));
}

} // namespace

GltfCounts::GltfCounts(const GltfJson& json)
    : textures(countOf(json, "textures")), images(countOf(json, "images")),
      views(countOf(json, "bufferViews"))
{
}

void dropUnused(GltfFile& file, const GltfCounts& before, const std::set<size_t>& replaced)
{
    for (const size_t texture : replaced) {
        if (isReferred(file, {"index", "texture"}, texture))
            continue;
        const auto removed = remove(file, "textures", texture, before.textures, "materials", "index");
        if (!removed || !removed->contains("source") || removed->contains("extensions"))
            continue; // other images may go with it
        const size_t image = (*removed)["source"];
        if (!isReferred(file, {"source", "image"}, image))
            dropImage(file, image, before);
    }
}

} // namespace lumel::baker
