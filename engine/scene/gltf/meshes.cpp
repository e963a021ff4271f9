// glTF meshes to triangle lists with complete vertices.
#include "charts/lit_uvs.h"
#include "reader.h"
#include "scene/vertex_frames.h"
#include <bit>
#include <numeric>

namespace lumel::scene {
namespace {

constexpr uint32_t kUnused = ~0u;

int attribute(const tinygltf::Primitive& primitive, const char* name)
{
    const auto found = primitive.attributes.find(name);
    return found == primitive.attributes.end() ? -1 : found->second;
}

bool isTriangles(int mode)
{
    return mode == TINYGLTF_MODE_TRIANGLES || mode == TINYGLTF_MODE_TRIANGLE_STRIP ||
           mode == TINYGLTF_MODE_TRIANGLE_FAN;
}

// glTF 2.0, section 3.7.2.1 "Topology types", with its winding. Triangles that name a vertex twice cover
// nothing and are left out.
std::vector<uint32_t> triangleList(const std::vector<uint32_t>& in, int mode)
{
    std::vector<uint32_t> out;
    const auto add = [&](uint32_t a, uint32_t b, uint32_t c) {
        if (a != b && b != c && c != a)
            out.insert(out.end(), {a, b, c});
    };
    if (mode == TINYGLTF_MODE_TRIANGLES)
        for (size_t i = 0; i + 2 < in.size(); i += 3)
            add(in[i], in[i + 1], in[i + 2]);
    else if (mode == TINYGLTF_MODE_TRIANGLE_STRIP)
        for (size_t i = 0; i + 2 < in.size(); ++i)
            add(in[i], in[i + 1 + i % 2], in[i + 2 - i % 2]);
    else
        for (size_t i = 0; i + 2 < in.size(); ++i)
            add(in[i + 1], in[i + 2], in[0]);
    return out;
}

// Keeps only the vertices that triangles use, in their order: exporters let many primitives share one
// large vertex buffer.
void dropUnused(Mesh& mesh)
{
    std::vector<uint32_t> renamed(mesh.vertices.size(), kUnused);
    for (uint32_t index : mesh.indices)
        renamed[index] = 0;
    uint32_t count = 0;
    for (size_t i = 0; i < renamed.size(); ++i) {
        if (renamed[i] == kUnused)
            continue;
        mesh.vertices[count] = mesh.vertices[i];
        if (!mesh.sources.empty())
            mesh.sources[count] = mesh.sources[i];
        renamed[i] = count++;
    }
    mesh.vertices.resize(count);
    mesh.sources.resize(std::min(mesh.sources.size(), size_t(count)));
    for (uint32_t& index : mesh.indices)
        index = renamed[index];
}

struct Attributes {
    int position, normal, tangent;
    std::array<int, 2> uv; // TEXCOORD_0 and _1
};

Attributes attributesOf(const tinygltf::Primitive& primitive)
{
    return {attribute(primitive, "POSITION"),
            attribute(primitive, "NORMAL"),
            attribute(primitive, "TANGENT"),
            {attribute(primitive, "TEXCOORD_0"), attribute(primitive, "TEXCOORD_1")}};
}

using UvSets = std::array<std::vector<glm::vec2>, 2>; // empty where the file has none

std::vector<float> readAttribute(const Reader& reader, int accessor, int components, Storage storage,
                                 const char* what, size_t vertexCount)
{
    if (accessor < 0)
        return {};
    if (accessorCount(reader, accessor) != vertexCount)
        reader.fail(fmt::format("{} (accessor {}) has {} elements for {} vertices", what, accessor,
                                accessorCount(reader, accessor), vertexCount));
    return readFloats(reader, accessor, components, storage, what);
}

void readVertices(Reader& reader, const Attributes& use, Mesh& mesh)
{
    const size_t count = accessorCount(reader, use.position);
    if (count > kMaxVertices)
        reader.fail(fmt::format("a mesh of {} vertices exceeds the limit of {}", count, kMaxVertices),
                    "split the mesh");
    const auto positions = readAttribute(reader, use.position, 3, Storage::floatOnly, "POSITION", count);
    const auto normals = readAttribute(reader, use.normal, 3, Storage::floatOnly, "NORMAL", count);
    const auto tangents = readAttribute(reader, use.tangent, 4, Storage::floatOnly, "TANGENT", count);
    mesh.vertices.assign(count, Vertex{});
    for (size_t i = 0; i < count; ++i) {
        Vertex& v = mesh.vertices[i];
        v.position = {positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]};
        if (!normals.empty())
            v.normal = {normals[3 * i], normals[3 * i + 1], normals[3 * i + 2]};
        if (!tangents.empty())
            v.tangent = {tangents[4 * i], tangents[4 * i + 1], tangents[4 * i + 2], tangents[4 * i + 3]};
    }
}

UvSets readUvSets(const Reader& reader, const Attributes& use, size_t vertexCount)
{
    UvSets sets;
    for (size_t s = 0; s < sets.size(); ++s) {
        const auto values = readAttribute(reader, use.uv[s], 2, Storage::floatOrUnorm,
                                          s == 0 ? "TEXCOORD_0" : "TEXCOORD_1", vertexCount);
        for (size_t i = 0; i + 1 < values.size(); i += 2)
            sets[s].emplace_back(values[i], values[i + 1]);
    }
    return sets;
}

// Where the material reads its maps.
void setMaterialUvs(const Reader& reader, const UvSets& sets, const Material& material, Mesh& mesh)
{
    const auto& own = sets[size_t(material.uv.set)];
    const auto& emissive = sets[size_t(material.emissionUv.set)];
    for (size_t i = 0; i < mesh.vertices.size(); ++i) {
        if (!own.empty())
            mesh.vertices[i].materialUv = material.uv(own[i]);
        if (!emissive.empty())
            mesh.vertices[i].emissionUv = material.emissionUv(emissive[i]);
        const glm::vec4 all(mesh.vertices[i].materialUv, mesh.vertices[i].emissionUv);
        if (!std::isfinite(all.x + all.y + all.z + all.w))
            reader.fail(
                fmt::format("mesh '{}': its material's KHR_texture_transform is out of range", mesh.name));
    }
}

// Alpha counts where the material's does. Colours beyond half floats' range make no picture.
void readColours(Reader& reader, int accessor, size_t fileVertices, AlphaMode mode, Mesh& mesh)
{
    const int components = isVec3(reader, accessor) ? 3 : 4;
    const auto values =
        readAttribute(reader, accessor, components, Storage::floatOrUnorm, "COLOR_0", fileVertices);
    for (const uint32_t source : mesh.sources) {
        const float* c = &values[size_t(components) * source];
        const float alpha = components == 4 && mode != AlphaMode::opaque ? c[3] : 1.0f;
        mesh.colours.push_back(glm::clamp(glm::vec4(c[0], c[1], c[2], alpha), 0.0f, 60000.0f));
    }
}

void readTriangles(Reader& reader, const tinygltf::Primitive& primitive, Mesh& mesh)
{
    std::vector<uint32_t> indices;
    if (primitive.indices >= 0) {
        indices = readIndices(reader, primitive.indices, mesh.vertices.size());
    } else {
        indices.resize(mesh.vertices.size());
        std::iota(indices.begin(), indices.end(), 0u);
    }
    if (primitive.mode == TINYGLTF_MODE_TRIANGLES && indices.size() % 3 != 0)
        reader.fail(fmt::format("mesh '{}' has {} indices, not a multiple of 3", mesh.name, indices.size()));
    mesh.indices = triangleList(indices, primitive.mode);
}

MadeFrames completeFrames(const Attributes& use, bool hasMaterialUvs, Mesh& mesh)
{
    if (use.normal < 0)
        makeFlatNormals(mesh);
    else
        repairNormals(mesh);
    if (use.tangent >= 0 && use.normal >= 0) // without normals the file's tangents count for nothing
        repairTangents(mesh);
    else if (hasMaterialUvs)
        makeTangents(mesh);
    else
        makeArbitraryTangents(mesh);
    return {.normals = use.normal < 0, .tangents = hasMaterialUvs && (use.tangent < 0 || use.normal < 0)};
}

void noteUndrawn(Reader& reader, const tinygltf::Primitive& primitive)
{
    auto& ignored = reader.document.ignored;
    if (primitive.attributes.contains("TEXCOORD_2"))
        ignored.insert("further UV sets");
    if (!isTriangles(primitive.mode))
        ignored.insert("points and lines");
}

// Index into scene.meshes, or -1 when there is nothing to draw.
int makeMesh(Reader& reader, const tinygltf::Primitive& primitive, const Material& material,
             const std::string& name, Scene& scene)
{
    noteUndrawn(reader, primitive);
    if (primitive.mode < TINYGLTF_MODE_POINTS || primitive.mode > TINYGLTF_MODE_TRIANGLE_FAN)
        reader.fail(fmt::format("mesh '{}' has the unknown mode {}", name, primitive.mode));
    if (!isTriangles(primitive.mode))
        return -1;
    const Attributes use = attributesOf(primitive);
    if (use.position < 0)
        reader.fail(fmt::format("mesh '{}' has no POSITION", name));
    Mesh mesh;
    mesh.name = name;
    readVertices(reader, use, mesh);
    readTriangles(reader, primitive, mesh);
    reader.countElements(mesh.vertices.size() + mesh.indices.size());
    if (mesh.indices.empty())
        return -1;
    const UvSets sets = readUvSets(reader, use, mesh.vertices.size());
    setMaterialUvs(reader, sets, material, mesh);
    chooseLitUvs(sets, mesh);
    const int colours = attribute(primitive, "COLOR_0");
    if (deforms(primitive) || colours >= 0) {
        mesh.sources.resize(mesh.vertices.size());
        std::iota(mesh.sources.begin(), mesh.sources.end(), 0u);
    }
    dropUnused(mesh);
    const MadeFrames made = completeFrames(use, !sets[size_t(material.uv.set)].empty(), mesh);
    for (const Vertex& v : mesh.vertices)
        mesh.bounds.add(v.position);
    if (deforms(primitive))
        readDeformation(reader, primitive, made, mesh);
    if (colours >= 0)
        readColours(reader, colours, accessorCount(reader, use.position), material.alphaMode, mesh);
    mesh.sources = {};
    reader.sceneVertices += mesh.vertices.size();
    if (reader.sceneVertices > kMaxSceneVertices)
        reader.fail(fmt::format("more than {} vertices", kMaxSceneVertices), "split the model");
    scene.meshes.push_back(std::move(mesh));
    return int(scene.meshes.size()) - 1;
}

// Primitives that differ in nothing that a mesh is made of.
std::vector<int> cacheKey(const tinygltf::Primitive& p, const Material& material)
{
    const Attributes use = attributesOf(p);
    std::vector<int> key = {p.mode, p.indices, use.position, use.normal, use.tangent, use.uv[0], use.uv[1]};
    for (const UvMapping& m : {material.uv, material.emissionUv}) {
        key.push_back(m.set);
        for (float value : {m.offset.x, m.offset.y, m.scale.x, m.scale.y, m.rotation})
            key.push_back(std::bit_cast<int>(value));
    }
    key.push_back(int(material.alphaMode)); // of the colours
    for (const char* name : {"COLOR_0", "JOINTS_0", "WEIGHTS_0", "JOINTS_1", "WEIGHTS_1"})
        key.push_back(attribute(p, name));
    for (const auto& target : p.targets)
        for (const char* name : {"POSITION", "NORMAL", "TANGENT"}) {
            const auto found = target.find(name);
            key.push_back(found == target.end() ? -1 : found->second);
        }
    return key;
}

} // namespace

std::vector<Primitive> readMesh(Reader& reader, int index, Scene& scene, PrimitiveCache& cache)
{
    if (index < 0 || size_t(index) >= reader.model.meshes.size())
        reader.fail(fmt::format("mesh {} does not exist", index));
    const tinygltf::Mesh& mesh = reader.model.meshes[size_t(index)];
    const std::string name = mesh.name.empty() ? fmt::format("mesh {}", index) : printable(mesh.name);
    std::vector<Primitive> primitives;
    for (size_t i = 0; i < mesh.primitives.size(); ++i) {
        const tinygltf::Primitive& p = mesh.primitives[i];
        if (p.targets.size() != mesh.primitives.front().targets.size())
            reader.fail(fmt::format("mesh '{}' has primitives of {} and of {} morph targets", name,
                                    mesh.primitives.front().targets.size(), p.targets.size()));
        if (p.material < -1 || p.material >= int(reader.model.materials.size()))
            reader.fail(fmt::format("mesh '{}' names material {}, which does not exist", name, p.material));
        const Material material = p.material >= 0 ? scene.materials[size_t(p.material)] : Material{};
        const auto [entry, isNew] = cache.try_emplace(cacheKey(p, material), -1);
        if (isNew)
            entry->second =
                makeMesh(reader, p, material,
                         mesh.primitives.size() == 1 ? name : fmt::format("{}#{}", name, i), scene);
        if (entry->second >= 0)
            primitives.push_back({entry->second, p.material});
    }
    return primitives;
}

} // namespace lumel::scene
