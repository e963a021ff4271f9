// Compresses the mesh of a GltfBuilder as exporters do, for the loader's tests and the fuzzers' seeds.
#pragma once
#include "gltf_builder.h"
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <meshoptimizer.h>

namespace lumel::scene {

// Replaces a buffer view, whose bytes hold `count` elements of `stride` bytes, by a compressed one.
inline void packView(GltfBuilder& gltf, size_t view, const std::string& packed, const char* mode,
                     size_t count, size_t stride, const char* filter = nullptr)
{
    const size_t at = gltf.view(packed.data(), packed.size());
    nlohmann::json extension = {{"buffer", 0},
                                {"byteOffset", gltf.root["bufferViews"][at]["byteOffset"]},
                                {"byteLength", packed.size()},
                                {"byteStride", stride},
                                {"mode", mode},
                                {"count", count}};
    if (filter)
        extension["filter"] = filter;
    gltf.root["bufferViews"][view] = {{"buffer", 1}, // the fallback that nobody stores
                                      {"byteLength", count * stride},
                                      {"extensions", {{"EXT_meshopt_compression", extension}}}};
    if (std::string(mode) == "ATTRIBUTES")
        gltf.root["bufferViews"][view]["byteStride"] = stride;
}

// Call it last of all that adds data.
inline void addFallbackBuffer(GltfBuilder& gltf)
{
    gltf.root["buffers"] = {
        {{"byteLength", gltf.binary.size()}, {"uri", "data.bin"}},
        {{"byteLength", 1024}, {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}}};
    gltf.root["extensionsUsed"].push_back("EXT_meshopt_compression");
    gltf.root["extensionsRequired"].push_back("EXT_meshopt_compression");
}

inline std::string packVertices(const void* vertices, size_t count, size_t stride)
{
    std::string packed(meshopt_encodeVertexBufferBound(count, stride), '\0');
    packed.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(packed.data()), packed.size(),
                                             vertices, count, stride));
    return packed;
}

inline std::string packTriangles(const std::vector<unsigned>& indices, size_t vertexCount)
{
    std::string packed(meshopt_encodeIndexBufferBound(indices.size(), vertexCount), '\0');
    packed.resize(meshopt_encodeIndexBuffer(reinterpret_cast<unsigned char*>(packed.data()), packed.size(),
                                            indices.data(), indices.size()));
    return packed;
}

inline std::string packSequence(const std::vector<unsigned>& indices, size_t vertexCount)
{
    std::string packed(meshopt_encodeIndexSequenceBound(indices.size(), vertexCount), '\0');
    packed.resize(meshopt_encodeIndexSequence(reinterpret_cast<unsigned char*>(packed.data()), packed.size(),
                                              indices.data(), indices.size()));
    return packed;
}

// The quad of GltfBuilder::quad(), all of it in meshopt's encoding.
inline void packQuadWithMeshopt(GltfBuilder& gltf)
{
    for (const char* name : {"POSITION", "NORMAL", "TEXCOORD_0"}) {
        const size_t view =
            gltf.root["accessors"][gltf.primitive()["attributes"][name].get<size_t>()]["bufferView"];
        const size_t offset = gltf.root["bufferViews"][view]["byteOffset"];
        const size_t stride = std::string(name) == "TEXCOORD_0" ? 8 : 12;
        packView(gltf, view, packVertices(gltf.binary.data() + offset, 4, stride), "ATTRIBUTES", 4, stride);
    }
    const size_t indices = gltf.root["accessors"][gltf.primitive()["indices"].get<size_t>()]["bufferView"];
    packView(gltf, indices, packTriangles({0, 1, 2, 0, 2, 3}, 4), "TRIANGLES", 6, 2);
    addFallbackBuffer(gltf);
}

// The unit square of GltfBuilder::quad() as a Draco mesh with positions and UVs; the encoder decides the
// order.
inline std::string dracoQuad()
{
    const float corners[4][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    const float uvs[4][2] = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
    const int triangles[2][3] = {{0, 1, 2}, {0, 2, 3}};
    draco::TriangleSoupMeshBuilder builder;
    builder.Start(2);
    const int position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
    const int uv = builder.AddAttribute(draco::GeometryAttribute::TEX_COORD, 2, draco::DT_FLOAT32);
    for (int f = 0; f < 2; ++f) {
        const int* t = triangles[f];
        const draco::FaceIndex face(static_cast<uint32_t>(f));
        builder.SetAttributeValuesForFace(position, face, corners[t[0]], corners[t[1]], corners[t[2]]);
        builder.SetAttributeValuesForFace(uv, face, uvs[t[0]], uvs[t[1]], uvs[t[2]]);
    }
    const auto mesh = builder.Finalize();
    draco::Encoder encoder;
    draco::EncoderBuffer buffer;
    const bool ok = encoder.EncodeMeshToBuffer(*mesh, &buffer).ok();
    return ok ? std::string(buffer.data(), buffer.size()) : std::string();
}

// A primitive whose accessors have no data of their own.
inline void packQuadWithDraco(GltfBuilder& gltf)
{
    const std::string packed = dracoQuad();
    const size_t view = gltf.view(packed.data(), packed.size());
    gltf.root["accessors"] = {{{"componentType", 5126}, {"type", "VEC3"}, {"count", 4}},
                              {{"componentType", 5126}, {"type", "VEC2"}, {"count", 4}},
                              {{"componentType", 5123}, {"type", "SCALAR"}, {"count", 6}}};
    gltf.primitive() = {{"attributes", {{"POSITION", 0}, {"TEXCOORD_0", 1}}},
                        {"indices", 2},
                        {"extensions",
                         {{"KHR_draco_mesh_compression",
                           {{"bufferView", view}, {"attributes", {{"POSITION", 0}, {"TEXCOORD_0", 1}}}}}}}};
    gltf.root["extensionsUsed"].push_back("KHR_draco_mesh_compression");
    gltf.root["extensionsRequired"].push_back("KHR_draco_mesh_compression");
}

} // namespace lumel::scene
