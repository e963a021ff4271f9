// KHR_draco_mesh_compression: the vertices and triangles of a primitive in one compressed buffer view.
#include "compression.h"
#include "core/error.h"
#include "limits.h"
#include <cstring>
#include <draco/compression/decode.h>
#include <draco/core/varint_decoding.h>
#include <draco/metadata/metadata_decoder.h>
#include <fmt/format.h>
#include <map>

namespace lumel::scene {
namespace {

using Json = nlohmann::json;

// Draco allocates what a header of a few bytes declares, so the header is read first. Draco bitstream 2.2,
// "Draco File Header", "Sequential Connectivity" and "Edgebreaker Connectivity". False when it declares
// more than kMaxVertices or is none.
bool modestHeader(std::span<const std::byte> bytes)
{
    constexpr size_t kHeaderBytes = 11;
    constexpr uint8_t kTriangularMesh = 1, kSequential = 0;
    constexpr uint16_t kMetadataFlag = 0x8000;
    if (bytes.size() < kHeaderBytes || std::memcmp(bytes.data(), "DRACO", 5) != 0)
        return false;
    const auto at = [&](size_t i) { return uint8_t(bytes[i]); };
    if (at(5) != 2 || at(6) != 2 || at(7) != kTriangularMesh)
        return false;
    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char*>(bytes.data()) + kHeaderBytes, bytes.size() - kHeaderBytes);
    buffer.set_bitstream_version(DRACO_BITSTREAM_VERSION(2, 2));
    if ((at(9) | at(10) << 8) & kMetadataFlag) {
        draco::GeometryMetadata metadata;
        if (!draco::MetadataDecoder().DecodeGeometryMetadata(&buffer, &metadata))
            return false;
    }
    uint32_t first = 0, second = 0; // faces and points, or the kind of traversal, vertices and faces
    uint8_t traversal = 0;
    if (at(8) != kSequential && !buffer.Decode(&traversal))
        return false;
    return draco::DecodeVarint(&first, &buffer) && draco::DecodeVarint(&second, &buffer) &&
           first <= kMaxVertices && second <= kMaxVertices;
}

template<class T>
bool copyValues(const draco::PointAttribute& attribute, uint32_t points, int components,
                std::vector<std::byte>& out)
{
    std::vector<T> value(static_cast<size_t>(components));
    for (uint32_t i = 0; i < points; ++i) {
        const auto index = attribute.mapped_index(draco::PointIndex(i));
        if (index.value() >= attribute.size() ||
            !attribute.ConvertValue<T>(index, int8_t(components), value.data()))
            return false;
        std::memcpy(out.data() + i * value.size() * sizeof(T), value.data(), value.size() * sizeof(T));
    }
    return true;
}

struct Format {
    size_t bytes; // of a component
    bool (*copy)(const draco::PointAttribute&, uint32_t, int, std::vector<std::byte>&);
};

// By glTF's component type; null for types that attributes cannot have.
const Format* formatOf(int componentType)
{
    static const std::map<int, Format> formats = {
        {5120, {1, copyValues<int8_t>}},   {5121, {1, copyValues<uint8_t>}},
        {5122, {2, copyValues<int16_t>}},  {5123, {2, copyValues<uint16_t>}},
        {5125, {4, copyValues<uint32_t>}}, {5126, {4, copyValues<float>}}};
    const auto found = formats.find(componentType);
    return found == formats.end() ? nullptr : &found->second;
}

int componentsOf(const std::string& type)
{
    return type == "SCALAR" ? 1 : type == "VEC2" ? 2 : type == "VEC3" ? 3 : type == "VEC4" ? 4 : 0;
}

std::vector<std::byte> triangleIndices(const draco::Mesh& mesh, std::vector<std::byte> bytes)
{
    for (uint32_t f = 0; f < mesh.num_faces(); ++f) {
        const draco::Mesh::Face& face = mesh.face(draco::FaceIndex(f));
        const uint32_t corners[3] = {face[0].value(), face[1].value(), face[2].value()};
        std::memcpy(bytes.data() + f * sizeof corners, corners, sizeof corners);
    }
    return bytes;
}

} // namespace

void CompressedDocument::expandPrimitive(Json& primitive, const Json& extension, const std::string& where)
{
    const auto packed = viewBytes(number(extension, "bufferView", where), where);
    if (!modestHeader(packed))
        fail(fmt::format("{} holds Draco data that is damaged or of more than {} triangles", where,
                         kMaxVertices));
    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char*>(packed.data()), packed.size());
    draco::Decoder decoder;
    auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
    if (!decoded.ok() || decoded.value()->num_faces() == 0)
        fail(fmt::format("{} holds damaged Draco data", where));
    const draco::Mesh& mesh = *decoded.value();
    const Json names = extension.value("attributes", Json::object());
    if (!names.is_object())
        fail(fmt::format("{} names no Draco attributes", where));
    for (const auto& [name, unused] : names.items()) {
        const std::string what = fmt::format("{}: {:.32}", where, name);
        const auto* attribute = mesh.GetAttributeByUniqueId(uint32_t(number(names, name.c_str(), what)));
        if (!attribute)
            fail(fmt::format("{} is not in the Draco data", what));
        const size_t index = number(primitive["attributes"], name.c_str(), what);
        if (!root_["accessors"].is_array() || index >= root_["accessors"].size())
            fail(fmt::format("{}: accessor {} does not exist", what, index));
        Json accessor = root_["accessors"][index];
        const size_t type = number(accessor, "componentType", what);
        const Format* format = formatOf(int(type));
        const int components =
            accessor.contains("type") && accessor["type"].is_string() ? componentsOf(accessor["type"]) : 0;
        if (!format || components == 0)
            fail(fmt::format("{}: accessor {} has an unknown type", what, index));
        std::vector<std::byte> bytes = allocate(mesh.num_points() * format->bytes * size_t(components));
        if (!format->copy(*attribute, mesh.num_points(), components, bytes))
            fail(fmt::format("{}: the Draco data does not fit accessor {}", what, index));
        for (const char* key : {"byteOffset", "sparse", "min", "max"})
            accessor.erase(key);
        accessor["count"] = mesh.num_points();
        primitive["attributes"][name] = addAccessor(std::move(accessor), std::move(bytes));
    }
    primitive["indices"] =
        addAccessor({{"componentType", 5125}, {"type", "SCALAR"}, {"count", size_t(mesh.num_faces()) * 3}},
                    triangleIndices(mesh, allocate(size_t(mesh.num_faces()) * 12)));
    primitive["mode"] = 4; // strips are decoded to a list of triangles
}

void CompressedDocument::expandDraco()
{
    const auto pointer = Json::json_pointer("/extensions/KHR_draco_mesh_compression");
    std::map<std::string, Json> done; // primitives that differ in their material only are decoded once
    const auto meshes = root_.find("meshes");
    if (meshes == root_.end() || !meshes->is_array())
        return;
    for (size_t m = 0; m < meshes->size(); ++m) {
        Json& mesh = (*meshes)[m];
        if (!mesh.is_object() || !mesh.contains("primitives") || !mesh["primitives"].is_array())
            continue;
        for (Json& primitive : mesh["primitives"]) {
            if (!primitive.is_object() || !primitive.contains(pointer))
                continue;
            const Json extension = primitive[pointer];
            primitive["extensions"].erase("KHR_draco_mesh_compression");
            if (!primitive.contains("attributes") || !primitive["attributes"].is_object())
                fail(fmt::format("mesh {} has a primitive without attributes", m));
            const std::string key = extension.dump() + primitive["attributes"].dump();
            if (const auto twin = done.find(key); twin != done.end()) {
                for (const char* member : {"attributes", "indices", "mode"})
                    primitive[member] = twin->second[member];
                continue;
            }
            expandPrimitive(primitive, extension, fmt::format("mesh {}", m));
            done[key] = primitive;
        }
    }
}

} // namespace lumel::scene
