#include "gltf_unused.h"
#include <algorithm>
#include <functional>

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

// The last element takes the place of `freed` if it was added. Returns where it was, or `freed` if none was.
size_t fill(GltfJson& array, size_t freed, size_t before)
{
    const size_t last = array.size() - 1;
    if (last < before)
        return freed;
    array[freed] = std::move(array[last]);
    array.erase(last);
    return last;
}

void renumber(GltfFile& file, const char* part, const char* key, size_t from, size_t to)
{
    forObjects(file.json[part], [&](GltfJson& object) {
        if (isNumber(object, key, from))
            object[key] = to;
    });
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

void dropView(GltfFile& file, size_t view, const GltfCounts& before)
{
    GltfJson& views = file.json["bufferViews"];
    const GltfJson old = views[view];
    const size_t moved = fill(views, view, before.views);
    if (moved == view)
        return;
    renumber(file, "images", "bufferView", moved, view);
    cut(file, at(old, "byteOffset"), at(old, "byteLength"));
}

void dropImage(GltfFile& file, size_t image, const GltfCounts& before)
{
    GltfJson& images = file.json["images"];
    const GltfJson old = images[image];
    const size_t moved = fill(images, image, before.images);
    if (moved == image)
        return;
    renumber(file, "textures", "source", moved, image);
    if (!old.contains("bufferView"))
        return;
    const size_t view = old["bufferView"];
    const bool isOurs = !file.binary.empty() && isNumber(file.json["bufferViews"][view], "buffer", 0);
    if (isOurs && !isReferred(file, {"bufferView"}, view))
        dropView(file, view, before);
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
        GltfJson& textures = file.json["textures"];
        const GltfJson old = textures[texture];
        const size_t moved = fill(textures, texture, before.textures);
        if (moved == texture)
            continue;
        renumber(file, "materials", "index", moved, texture);
        if (!old.contains("source") || old.contains("extensions"))
            continue; // other images may go with it
        const size_t image = old["source"];
        if (!isReferred(file, {"source", "image"}, image))
            dropImage(file, image, before);
    }
}

} // namespace lumel::baker
