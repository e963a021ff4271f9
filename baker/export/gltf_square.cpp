#include "gltf_square.h"
#include "core/image.h"
#include "export_maps.h"
#include "gltf_file.h"
#include <array>
#include <fmt/format.h>
#include <tbb/parallel_for.h>

namespace lumel::baker {
namespace {

const ExportMap* find(const std::vector<ExportMap>& maps, const std::string& name)
{
    const auto found = std::ranges::find(maps, name, &ExportMap::name);
    return found == maps.end() ? nullptr : &*found;
}

// Corners with normals and tangents, facing +Z, and two triangles.
void addSquare(GltfFile& file)
{
    constexpr float kHalf = 0.5f;
    const std::array<float, 12> positions{-kHalf, -kHalf, 0, kHalf,  -kHalf, 0,
                                          kHalf,  kHalf,  0, -kHalf, kHalf,  0};
    const std::array<float, 12> normals{0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1};
    const std::array<float, 16> tangents{1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1};
    const std::array<float, 8> uvs{0, 1, 1, 1, 1, 0, 0, 0};
    const std::array<uint16_t, 6> indices{0, 1, 2, 0, 2, 3};
    constexpr int kFloat = 5126, kShort = 5123;
    const auto accessor = [&](const auto& values, int type, const char* shape, size_t count) {
        const size_t view = file.addView(std::as_bytes(std::span(values)));
        constexpr int kVertices = 34962, kIndices = 34963;
        file.json["bufferViews"][view]["target"] = type == kShort ? kIndices : kVertices;
        return file.add("accessors",
                        {{"bufferView", view}, {"componentType", type}, {"count", count}, {"type", shape}});
    };
    const size_t position = accessor(positions, kFloat, "VEC3", 4);
    file.json["accessors"][position]["min"] = {-kHalf, -kHalf, 0};
    file.json["accessors"][position]["max"] = {kHalf, kHalf, 0};
    const GltfJson attributes = {{"POSITION", position},
                                 {"NORMAL", accessor(normals, kFloat, "VEC3", 4)},
                                 {"TANGENT", accessor(tangents, kFloat, "VEC4", 4)},
                                 {"TEXCOORD_0", accessor(uvs, kFloat, "VEC2", 4)}};
    const GltfJson primitive = {
        {"attributes", attributes}, {"indices", accessor(indices, kShort, "SCALAR", 6)}, {"material", 0}};
    file.add("meshes", {{"name", "square"}, {"primitives", GltfJson::array({primitive})}});
    file.add("nodes", {{"name", "square"}, {"mesh", 0}});
    file.add("scenes", {{"nodes", GltfJson::array({0})}});
    file.json["scene"] = 0;
}

} // namespace

nlohmann::json writeGltfSquare(const std::string& name, const std::vector<ExportMap>& maps, bool binary,
                               StagedFiles& files)
{
    GltfFile file;
    file.json["asset"] = {{"version", "2.0"}, {"generator", "lumel export"}};
    nlohmann::json written = nlohmann::json::array();
    std::vector<std::vector<unsigned char>> pngs(maps.size());
    tbb::parallel_for(size_t(0), maps.size(), [&](size_t i) {
        if (maps[i].name != "specular") // which the material does not use
            pngs[i] = pngOf(maps[i]);
    });
    const auto texture = [&](const ExportMap& map) -> GltfJson {
        const std::vector<unsigned char>& png = pngs[size_t(&map - maps.data())];
        size_t image = 0;
        if (binary) {
            image = file.addPng(map.name, png);
        } else {
            const std::string uri = fmt::format("{}_{}.png", name, map.name);
            files.write(uri, std::as_bytes(std::span(png)));
            written.push_back(uri);
            image = file.add("images", {{"name", map.name}, {"uri", uri}});
        }
        return {{"index", file.add("textures", {{"source", image}})}};
    };
    GltfJson material = {{"name", name}};
    material["normalTexture"] = texture(*find(maps, "normal"));
    const ExportMap* rough = find(maps, "metallic_roughness");
    if (!rough)
        rough = find(maps, "occlusion_roughness_metallic");
    material["pbrMetallicRoughness"] = {{"baseColorTexture", texture(*find(maps, "base_color"))},
                                        {"metallicRoughnessTexture", texture(*rough)}};
    if (const ExportMap* anisotropy = find(maps, "anisotropy")) {
        material["extensions"]["KHR_materials_anisotropy"] = {{"anisotropyStrength", 1.0},
                                                              {"anisotropyTexture", texture(*anisotropy)}};
        file.json["extensionsUsed"] = GltfJson::array({"KHR_materials_anisotropy"});
    }
    file.add("materials", std::move(material));
    addSquare(file);
    if (binary) {
        const std::vector<std::byte> bytes = file.glb();
        files.write(name + ".glb", bytes);
        written.push_back(name + ".glb");
    } else {
        file.json["buffers"][0]["uri"] = name + ".bin";
        files.write(name + ".bin", file.binary);
        files.write(name + ".gltf", file.json.dump(1) + "\n");
        written.push_back(name + ".bin");
        written.push_back(name + ".gltf");
    }
    return written;
}

} // namespace lumel::baker
