// Writes the fuzzers' seed corpus: fuzz_seeds FOLDER makes FOLDER/gltf and FOLDER/exr.
#include "../unit/scene/gltf_compress.h"
#include "baker/bake.h"
#include <cstdio>

namespace lumel::scene {
namespace {

// One file each: the binary data as a data: URI, so that no length in the file has to agree with another.
void write(const std::filesystem::path& folder, const std::string& name, GltfBuilder gltf)
{
    nlohmann::json buffers = gltf.root.value("buffers", nlohmann::json::array({nlohmann::json::object()}));
    buffers[0] = {{"byteLength", gltf.binary.size()}, {"uri", "data:;base64," + base64(gltf.binary)}};
    gltf.root["buffers"] = buffers;
    writeText(folder / (name + ".gltf"), gltf.root.dump());
}

size_t addImage(GltfBuilder& gltf, const char* format)
{
    TemporaryFolder folder;
    Image image(4, 4, 3);
    for (size_t i = 0; i < image.pixels.size(); ++i)
        image.pixels[i] = float(i % 7) / 7.0f;
    writeImage(folder / (std::string("image.") + format), image);
    const std::string bytes = readText(folder / (std::string("image.") + format));
    gltf.root["images"].push_back({{"bufferView", gltf.view(bytes.data(), bytes.size())}});
    gltf.root["textures"].push_back({{"source", gltf.root["images"].size() - 1}});
    return gltf.root["textures"].size() - 1;
}

GltfBuilder materials()
{
    GltfBuilder gltf;
    gltf.quad();
    const nlohmann::json png = {{"index", addImage(gltf, "png")}}, jpeg = {{"index", addImage(gltf, "jpg")}};
    gltf.material(0) = {
        {"pbrMetallicRoughness",
         {{"baseColorTexture", png}, {"metallicRoughnessTexture", jpeg}, {"metallicFactor", 0.5}}},
        {"normalTexture", {{"index", 0}, {"scale", 0.5}}},
        {"emissiveTexture", png},
        {"emissiveFactor", {1, 0.5, 0}},
        {"occlusionTexture", {{"index", 1}, {"strength", 0.5}}},
        {"alphaMode", "MASK"},
        {"extensions",
         {{"KHR_materials_emissive_strength", {{"emissiveStrength", 4}}},
          {"KHR_materials_ior", {{"ior", 1.4}}},
          {"KHR_materials_specular",
           {{"specularFactor", 0.5}, {"specularTexture", png}, {"specularColorFactor", {1, 0, 1}}}},
          {"KHR_materials_anisotropy",
           {{"anisotropyStrength", 0.5}, {"anisotropyRotation", 1}, {"anisotropyTexture", jpeg}}}}}};
    gltf.material(1) = {{"extensions",
                         {{"KHR_materials_unlit", nlohmann::json::object()},
                          {"KHR_materials_pbrSpecularGlossiness",
                           {{"diffuseFactor", {1, 1, 0, 1}}, {"specularGlossinessTexture", png}}}}}};
    gltf.material(2) = {
        {"extras", {{"lumel", {{"heightTexture", {{"index", 0}}}, {"heightScale", 0.1}, {"power", 30}}}}}};
    gltf.root["meshes"][0]["primitives"].push_back(gltf.primitive(0));
    gltf.root["meshes"][0]["primitives"].push_back(gltf.primitive(0));
    for (size_t i = 0; i < 3; ++i)
        gltf.primitive(i)["material"] = i;
    return gltf;
}

GltfBuilder nodes()
{
    GltfBuilder gltf;
    gltf.quad();
    gltf.node()["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
        {"TRANSLATION", gltf.floats({0, 0, 0, 2, 0, 0}, "VEC3", 3)},
        {"ROTATION", gltf.floats({0, 0, 0, 1, 0, 1, 0, 1}, "VEC4", 4)}};
    gltf.node()["children"] = {1};
    gltf.root["nodes"].push_back({{"camera", 0},
                                  {"rotation", {0, 0, 0, 1}},
                                  {"scale", {1, 1, 1}},
                                  {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    gltf.root["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}}};
    gltf.root["extensions"]["KHR_lights_punctual"]["lights"] = {
        {{"type", "spot"}, {"intensity", 9}, {"spot", {{"innerConeAngle", 0.1}, {"outerConeAngle", 0.5}}}}};
    const uint16_t index = 3;
    const float value[3] = {0, 1, 0};
    const size_t indices = gltf.view(&index, 2), values = gltf.view(value, 12);
    gltf.root["accessors"][0]["sparse"] = {{"count", 1},
                                           {"indices", {{"bufferView", indices}, {"componentType", 5123}}},
                                           {"values", {{"bufferView", values}}}};
    return gltf;
}

GltfBuilder quantised()
{
    GltfBuilder gltf;
    gltf.root["extensionsUsed"] = {"KHR_mesh_quantization"};
    gltf.quad();
    gltf.primitive()["attributes"]["POSITION"] =
        gltf.accessor<int16_t>({0, 0, 0, 0, 9, 0, 0, 0, 9, 9, 0, 0, 0, 9, 0, 0}, "VEC3", 5122, 4);
    gltf.root["bufferViews"].back()["byteStride"] = 8;
    gltf.primitive()["mode"] = 5;
    return gltf;
}

// Two joints, two morph targets, colours, and animations of all of them.
GltfBuilder deformed()
{
    GltfBuilder gltf;
    gltf.quad();
    auto& attributes = gltf.primitive()["attributes"];
    attributes["JOINTS_0"] =
        gltf.accessor<uint8_t>({0, 1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0}, "VEC4", 5121, 4);
    attributes["WEIGHTS_0"] = gltf.floats({1, 0, 0, 0, 0.5, 0.5, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0}, "VEC4", 4);
    attributes["COLOR_0"] = gltf.floats({1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1}, "VEC3", 3);
    gltf.primitive()["targets"] = {{{"POSITION", 0}, {"NORMAL", 1}}, {{"POSITION", 1}}};
    gltf.root["meshes"][0]["weights"] = {0.5, 1};
    gltf.root["nodes"] = {
        {{"mesh", 0}, {"skin", 0}, {"weights", {0, 1}}}, {{"children", {2}}}, {{"translation", {0, 1, 0}}}};
    gltf.root["scenes"] = {{{"nodes", {0, 1}}}};
    std::vector<float> inverses(32, 0.0f);
    for (size_t i = 0; i < 32; i += 5)
        inverses[i + i / 16] = 1.0f;
    gltf.root["skins"] = {{{"joints", {1, 2}}, {"inverseBindMatrices", gltf.floats(inverses, "MAT4", 16)}}};
    gltf.root["animations"] = {{{"samplers",
                                 {{{"input", gltf.floats({0, 1}, "SCALAR", 1)},
                                   {"output", gltf.floats({0, 0, 1, 0, 0, 0, 0, 0, 0, 1, 0, 0}, "SCALAR", 1)},
                                   {"interpolation", "CUBICSPLINE"}},
                                  {{"input", gltf.floats({0, 1}, "SCALAR", 1)},
                                   {"output", gltf.floats({0, 0, 0, 1, 0, 0, 1, 0}, "VEC4", 4)}}}},
                                {"channels",
                                 {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}},
                                  {{"sampler", 1}, {"target", {{"node", 2}, {"path", "rotation"}}}}}}}};
    return gltf;
}

void writeGltfSeeds(const std::filesystem::path& folder)
{
    std::filesystem::create_directories(folder);
    GltfBuilder plain, meshopt, draco;
    plain.quad();
    write(folder, "plain", plain);
    writeText(folder / "binary.gltf", plain.glb());
    meshopt.quad();
    packQuadWithMeshopt(meshopt);
    write(folder, "meshopt", meshopt);
    packQuadWithDraco(draco);
    write(folder, "draco", draco);
    write(folder, "materials", materials());
    write(folder, "nodes", nodes());
    write(folder, "deformed", deformed());
    write(folder, "quantised", quantised());
}

void writeExrSeeds(const std::filesystem::path& folder)
{
    std::filesystem::create_directories(folder);
    for (int size : {1, 4, 9}) {
        baker::Maps maps;
        maps.height = Image(size, size, 1);
        for (size_t i = 0; i < maps.height.pixels.size(); ++i)
            maps.height.pixels[i] = float(i * 5 % 7) / 7.0f;
        maps.heightScale = 0.1f;
        for (bool asFloat : {false, true})
            baker::bakeExr(folder / ("baked" + std::to_string(size) + (asFloat ? "f" : "h") + ".exr"), maps,
                           {}, asFloat, nullptr);
        baker::bakeExr(folder / ("pairs" + std::to_string(size) + ".exr"), maps,
                       {.lobes = baker::LobeCount::two}, false, nullptr);
    }
}

} // namespace
} // namespace lumel::scene

int main(int count, char** arguments)
{
    if (count != 2) {
        std::fprintf(stderr, "usage: fuzz_seeds FOLDER\n");
        return 2;
    }
    lumel::scene::writeGltfSeeds(std::filesystem::path(arguments[1]) / "gltf");
    lumel::scene::writeExrSeeds(std::filesystem::path(arguments[1]) / "exr");
    return 0;
}
