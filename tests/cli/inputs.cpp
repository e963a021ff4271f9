#include "inputs.h"
#include "core/image.h"
#include "program.h"
#include <cmath>
#include <cstdint>

namespace lumel::cli {

void writeHeightMap(const std::filesystem::path& file, int width, int height)
{
    Image image(width, height, 1);
    uint32_t random = 1;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            random = random * 1664525u + 1013904223u; // Numerical Recipes' generator
            const float grain = float(random >> 8) * 0x1p-24f;
            *image.at(x, y) =
                0.5f + 0.3f * std::sin(0.7f * float(x)) * std::cos(0.4f * float(y)) + 0.2f * (grain - 0.5f);
        }
    writeImage(file, image);
}

nlohmann::json squareScene(const std::filesystem::path& gltf)
{
    using nlohmann::json;
    // Four corners: positions, then texture coordinates, then six 16-bit indices.
    const float numbers[] = {-1, -1, 0,    1,    -1,   0,    1,    1,    0,    -1,
                             1,  0,  0.1f, 0.9f, 0.9f, 0.9f, 0.9f, 0.1f, 0.1f, 0.1f};
    const uint16_t indices[] = {0, 1, 2, 0, 2, 3};
    std::string bin(reinterpret_cast<const char*>(numbers), sizeof numbers);
    bin.append(reinterpret_cast<const char*>(indices), sizeof indices);
    const std::string binName = gltf.stem().string() + ".bin", imageName = gltf.stem().string() + ".png";
    writeText(gltf.parent_path() / binName, bin);
    writeHeightMap(gltf.parent_path() / imageName, 64, 64);

    json document;
    document["asset"]["version"] = "2.0";
    document["buffers"] = {{{"uri", binName}, {"byteLength", bin.size()}}};
    document["bufferViews"] = {{{"buffer", 0}, {"byteOffset", 0}, {"byteLength", 48}},
                               {{"buffer", 0}, {"byteOffset", 48}, {"byteLength", 32}},
                               {{"buffer", 0}, {"byteOffset", 80}, {"byteLength", 12}}};
    document["accessors"] = {{{"bufferView", 0},
                              {"componentType", 5126},
                              {"count", 4},
                              {"type", "VEC3"},
                              {"min", {-1, -1, 0}},
                              {"max", {1, 1, 0}}},
                             {{"bufferView", 1}, {"componentType", 5126}, {"count", 4}, {"type", "VEC2"}},
                             {{"bufferView", 2}, {"componentType", 5123}, {"count", 6}, {"type", "SCALAR"}}};
    document["images"] = {{{"uri", imageName}}};
    document["textures"] = {{{"source", 0}}};
    document["materials"] = {
        {{"pbrMetallicRoughness", {{"metallicFactor", 0.0}, {"roughnessFactor", 0.4}}},
         {"extras", {{"lumel", {{"heightTexture", {{"index", 0}}}, {"heightScale", 0.02}}}}}}};
    document["meshes"] = {
        {{"primitives",
          {{{"attributes", {{"POSITION", 0}, {"TEXCOORD_0", 1}}}, {"indices", 2}, {"material", 0}}}}}};
    document["nodes"] = {{{"mesh", 0}}};
    document["scenes"] = {{{"nodes", {0}}}};
    document["scene"] = 0;
    return document;
}

void addMotion(nlohmann::json& document, const std::filesystem::path& gltf, int node,
               std::array<float, 3> from, std::array<float, 3> to)
{
    const float numbers[] = {0, 2, from[0], from[1], from[2], to[0], to[1], to[2]};
    const std::filesystem::path file = gltf.parent_path() / (gltf.stem().string() + ".bin");
    std::string bin = readText(file);
    auto& views = document["bufferViews"];
    auto& accessors = document["accessors"];
    const size_t view = views.size(), accessor = accessors.size();
    views.push_back({{"buffer", 0}, {"byteOffset", bin.size()}, {"byteLength", 8}});
    views.push_back({{"buffer", 0}, {"byteOffset", bin.size() + 8}, {"byteLength", 24}});
    bin.append(reinterpret_cast<const char*>(numbers), sizeof numbers);
    writeText(file, bin);
    document["buffers"][0]["byteLength"] = bin.size();
    accessors.push_back({{"bufferView", view}, {"componentType", 5126}, {"count", 2}, {"type", "SCALAR"}});
    accessors.push_back({{"bufferView", view + 1}, {"componentType", 5126}, {"count", 2}, {"type", "VEC3"}});
    document["animations"] = {
        {{"samplers", {{{"input", accessor}, {"output", accessor + 1}}}},
         {"channels", {{{"sampler", 0}, {"target", {{"node", node}, {"path", "translation"}}}}}}}};
}

void addLight(nlohmann::json& document, const char* type, float intensity)
{
    document["extensionsUsed"] = {"KHR_lights_punctual"};
    document["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", type}, {"intensity", intensity}}};
    document["nodes"].push_back({{"translation", {0, 0, 2}},
                                 {"rotation", {0.2588190451, 0, 0, -0.9659258263}},
                                 {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    document["scenes"][0]["nodes"].push_back(document["nodes"].size() - 1);
}

void writeScene(const std::filesystem::path& gltf, const nlohmann::json& document)
{
    writeText(gltf, document.dump());
}

} // namespace lumel::cli
