// Accessors to arrays. glTF 2.0, section 3.6: accessor -> buffer view -> buffer, each with an offset and
// a length that the file may lie about.
#include "reader.h"
#include <cstring>
#include <limits>

namespace lumel::scene {
namespace {

// Elements that are known to lie inside a buffer.
struct Elements {
    const std::byte* data = nullptr; // null: all zero
    size_t stride = 0;
    size_t count = 0;
    int componentType = 0;
};

// 0 for types that glTF 2.0 does not know (tinygltf lets INT and DOUBLE pass).
size_t componentSize(int type)
{
    switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return 1;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return 2;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
        return 4;
    default:
        return 0;
    }
}

// Checks that `count` elements of `size` bytes fit. Nothing here can overflow: sizes are of memory that
// exists, and the division comes before the multiplication.
const std::byte* checkedRange(const Reader& reader, int accessor, std::span<const std::byte> view,
                              size_t offset, size_t count, size_t size, size_t stride)
{
    if (stride < size)
        reader.fail(
            fmt::format("accessor {} has a stride of {} bytes for elements of {}", accessor, stride, size));
    if (offset > view.size() || view.size() - offset < size ||
        (view.size() - offset - size) / stride < count - 1)
        reader.fail(fmt::format("accessor {} reads past the end of its buffer view", accessor));
    return view.data() + offset;
}

const tinygltf::Accessor& accessorAt(const Reader& reader, int accessor)
{
    if (accessor < 0 || size_t(accessor) >= reader.model.accessors.size())
        reader.fail(fmt::format("accessor {} does not exist", accessor));
    return reader.model.accessors[size_t(accessor)];
}

Elements checkedElements(const Reader& reader, int index, int components)
{
    const tinygltf::Accessor& accessor = accessorAt(reader, index);
    const size_t size = componentSize(accessor.componentType) * size_t(components);
    if (size == 0)
        reader.fail(
            fmt::format("accessor {} has the unknown component type {}", index, accessor.componentType));
    const int type = components == 1    ? TINYGLTF_TYPE_SCALAR
                     : components == 16 ? TINYGLTF_TYPE_MAT4
                                        : components; // VEC2 to VEC4 are 2 to 4
    if (accessor.type != type)
        reader.fail(fmt::format("accessor {} has the wrong type for its use", index));
    if (accessor.count == 0)
        reader.fail(fmt::format("accessor {} has no elements", index));
    if (accessor.bufferView < 0) {
        // All zero until sparse values come: the only accessor whose size no buffer bounds.
        if (accessor.count > kMaxVertices)
            reader.fail(fmt::format("accessor {} has more than {} elements", index, kMaxVertices));
        return {nullptr, size, accessor.count, accessor.componentType};
    }
    const auto view = bufferViewBytes(reader, accessor.bufferView);
    const size_t byteStride = reader.model.bufferViews[size_t(accessor.bufferView)].byteStride;
    const size_t stride = byteStride ? byteStride : size;
    const std::byte* data =
        checkedRange(reader, index, view, accessor.byteOffset, accessor.count, size, stride);
    return {data, stride, accessor.count, accessor.componentType};
}

template<class T>
T load(const std::byte* from)
{
    T value;
    std::memcpy(&value, from, sizeof value); // files align as they like
    return value;
}

uint32_t loadUnsigned(const std::byte* from, int type)
{
    switch (type) {
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return load<uint8_t>(from);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return load<uint16_t>(from);
    default:
        return load<uint32_t>(from);
    }
}

template<class T>
float loadInteger(const std::byte* from, bool normalised)
{
    const float value = float(load<T>(from));
    return normalised ? std::max(value / float(std::numeric_limits<T>::max()), -1.0f) : value;
}

// glTF 2.0, section 3.6.2.2 "Accessor data types", with its formulas for normalised integers.
float loadFloat(const std::byte* from, int type, bool normalised)
{
    switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
        return loadInteger<int8_t>(from, normalised);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return loadInteger<uint8_t>(from, normalised);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
        return loadInteger<int16_t>(from, normalised);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return loadInteger<uint16_t>(from, normalised);
    default:
        return load<float>(from);
    }
}

bool isSmallInteger(int type)
{
    return componentSize(type) == 1 || componentSize(type) == 2;
}

// KHR_mesh_quantization adds signed and not normalised integers. Its table leaves some combinations out;
// what is read of them is what they say.
bool allowed(const Reader& reader, Storage storage, const tinygltf::Accessor& accessor)
{
    if (accessor.componentType == TINYGLTF_COMPONENT_TYPE_FLOAT)
        return storage != Storage::unsignedInteger;
    if (!isSmallInteger(accessor.componentType))
        return false;
    const bool isSigned = accessor.componentType == TINYGLTF_COMPONENT_TYPE_BYTE ||
                          accessor.componentType == TINYGLTF_COMPONENT_TYPE_SHORT;
    switch (storage) {
    case Storage::floatOnly:
        return reader.document.quantised;
    case Storage::floatOrUnorm:
        return reader.document.quantised || (accessor.normalized && !isSigned);
    case Storage::floatOrNormalized:
        return accessor.normalized;
    case Storage::unsignedInteger:
        return !isSigned && !accessor.normalized;
    }
    return false;
}

bool isUnsigned(int type)
{
    return type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE || type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
           type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
}

// glTF 2.0, section 3.6.2.3: calls set(element, bytes) for each replaced element.
template<class Set>
void applySparse(const Reader& reader, int index, size_t elementSize, const Set& set)
{
    const tinygltf::Accessor& accessor = accessorAt(reader, index);
    const auto& sparse = accessor.sparse;
    if (!sparse.isSparse)
        return;
    const size_t indexSize = componentSize(sparse.indices.componentType);
    if (sparse.count < 1 || size_t(sparse.count) > accessor.count || sparse.indices.byteOffset < 0 ||
        sparse.values.byteOffset < 0 || indexSize == 0 || !isUnsigned(sparse.indices.componentType))
        reader.fail(fmt::format("accessor {} has unusable sparse values", index));
    const size_t count = size_t(sparse.count);
    const std::byte* indices = checkedRange(reader, index, bufferViewBytes(reader, sparse.indices.bufferView),
                                            size_t(sparse.indices.byteOffset), count, indexSize, indexSize);
    const std::byte* values = checkedRange(reader, index, bufferViewBytes(reader, sparse.values.bufferView),
                                           size_t(sparse.values.byteOffset), count, elementSize, elementSize);
    for (size_t i = 0; i < count; ++i) {
        const uint32_t element = loadUnsigned(indices + i * indexSize, sparse.indices.componentType);
        if (element >= accessor.count)
            reader.fail(fmt::format("accessor {} has a sparse index out of range", index));
        set(element, values + i * elementSize);
    }
}

} // namespace

std::span<const std::byte> bufferViewBytes(const Reader& reader, int index)
{
    if (index < 0 || size_t(index) >= reader.model.bufferViews.size())
        reader.fail(fmt::format("buffer view {} does not exist", index));
    const tinygltf::BufferView& view = reader.model.bufferViews[size_t(index)];
    if (view.buffer < 0 || size_t(view.buffer) >= reader.document.buffers.size())
        reader.fail(fmt::format("buffer {} does not exist", view.buffer));
    const std::span<const std::byte> buffer = reader.document.buffers[size_t(view.buffer)];
    if (view.byteOffset > buffer.size() || view.byteLength > buffer.size() - view.byteOffset)
        reader.fail(fmt::format("buffer view {} reads past the end of its buffer", index));
    return buffer.subspan(view.byteOffset, view.byteLength);
}

size_t accessorCount(const Reader& reader, int accessor)
{
    return accessorAt(reader, accessor).count;
}

bool isVec3(const Reader& reader, int accessor)
{
    return accessorAt(reader, accessor).type == TINYGLTF_TYPE_VEC3;
}

std::vector<float> readFloats(const Reader& reader, int index, int components, Storage storage,
                              const char* what)
{
    const Elements elements = checkedElements(reader, index, components);
    const int type = elements.componentType;
    if (!allowed(reader, storage, accessorAt(reader, index)))
        reader.fail(
            fmt::format("{} (accessor {}) is stored in a type that glTF 2.0 does not allow", what, index));
    const bool normalised = accessorAt(reader, index).normalized;
    if (elements.count > kMaxVertices)
        reader.fail(fmt::format("{} (accessor {}) has more than {} elements", what, index, kMaxVertices),
                    "split the mesh");
    const size_t size = componentSize(type);
    std::vector<float> values(elements.count * size_t(components));
    const auto set = [&](size_t element, const std::byte* from) {
        for (size_t c = 0; c < size_t(components); ++c)
            values[element * size_t(components) + c] = loadFloat(from + c * size, type, normalised);
    };
    if (elements.data)
        for (size_t i = 0; i < elements.count; ++i)
            set(i, elements.data + i * elements.stride);
    applySparse(reader, index, size * size_t(components), set);
    for (float value : values)
        if (!std::isfinite(value))
            reader.fail(fmt::format("{} (accessor {}) holds a value that is not finite", what, index));
    return values;
}

std::vector<uint32_t> readIndices(const Reader& reader, int index, size_t vertexCount)
{
    const Elements elements = checkedElements(reader, index, 1);
    if (!isUnsigned(elements.componentType))
        reader.fail(
            fmt::format("indices (accessor {}) are stored in a type that glTF 2.0 does not allow", index));
    if (elements.count > kMaxIndices)
        reader.fail(fmt::format("a mesh of {} indices exceeds the limit of {}", elements.count, kMaxIndices),
                    "split the mesh");
    std::vector<uint32_t> values(elements.count);
    if (elements.data)
        for (size_t i = 0; i < elements.count; ++i)
            values[i] = loadUnsigned(elements.data + i * elements.stride, elements.componentType);
    applySparse(reader, index, componentSize(elements.componentType),
                [&](size_t element, const std::byte* from) {
                    values[element] = loadUnsigned(from, elements.componentType);
                });
    for (uint32_t value : values)
        if (value >= vertexCount)
            reader.fail(fmt::format("indices (accessor {}) name vertex {} of {}", index, value, vertexCount));
    return values;
}

} // namespace lumel::scene
