// Materials and images of a correct file.
#include "gltf_builder.h"

namespace lumel::scene {
namespace {

using nlohmann::json;

struct GltfMaterials : testing::Test {
    TemporaryFolder folder;
    GltfBuilder gltf;
    Scene load() { return loadGltf(gltf.writeGltf(folder)); }
};

TEST_F(GltfMaterials, MaterialsAreReadWhole)
{
    gltf.quad();
    for (const char* name : {"a.png", "b.png", "c.png", "d.png"})
        writeText(folder / name, std::string("never decoded: ") + name);
    gltf.root["images"] = {{{"uri", "a.png"}}, {{"uri", "b.png"}}, {{"uri", "c.png"}}, {{"uri", "d.png"}}};
    gltf.root["textures"] = {{{"source", 3}}, {{"source", 2}}, {{"source", 1}}, {{"source", 0}}};
    gltf.material() = {{"name", "all"},
                       {"pbrMetallicRoughness",
                        {{"baseColorFactor", {0.1, 0.2, 0.3, 0.4}},
                         {"metallicFactor", 0.5},
                         {"roughnessFactor", 0.6},
                         {"baseColorTexture", {{"index", 0}}},
                         {"metallicRoughnessTexture", {{"index", 1}}}}},
                       {"normalTexture", {{"index", 2}, {"scale", 0.7}}},
                       {"occlusionTexture", {{"index", 1}, {"strength", 0.8}}},
                       {"emissiveTexture", {{"index", 3}}},
                       {"emissiveFactor", {0.5, 0.25, 1}},
                       {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 8}}}}},
                       {"alphaMode", "MASK"},
                       {"alphaCutoff", 0.3},
                       {"doubleSided", true}};
    gltf.primitive()["material"] = 0;
    const Scene scene = load();
    const Material& m = scene.materials.at(0);
    EXPECT_EQ(m.name, "all");
    EXPECT_EQ(m.baseColor, glm::vec4(0.1f, 0.2f, 0.3f, 0.4f));
    EXPECT_FLOAT_EQ(m.metallic, 0.5f);
    EXPECT_FLOAT_EQ(m.roughness, 0.6f);
    EXPECT_FLOAT_EQ(m.normalScale, 0.7f);
    EXPECT_FLOAT_EQ(m.occlusionStrength, 0.8f);
    EXPECT_EQ(m.emissive, glm::vec3(4, 2, 8));
    EXPECT_EQ(m.baseColorImage, 3);
    EXPECT_EQ(m.metallicRoughnessImage, 2);
    EXPECT_EQ(m.normalImage, 1);
    EXPECT_EQ(m.occlusionImage, 2);
    EXPECT_EQ(m.emissiveImage, 0);
    EXPECT_EQ(m.alphaMode, AlphaMode::mask);
    EXPECT_FLOAT_EQ(m.alphaCutoff, 0.3f);
    EXPECT_TRUE(m.doubleSided);
    const std::vector<std::byte>& bytes = scene.images.at(1).bytes;
    EXPECT_EQ(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()), "never decoded: b.png");
    EXPECT_EQ(scene.images[1].name, (folder / "b.png").string());
}

TEST_F(GltfMaterials, DefaultsAreThoseOfTheSpecification)
{
    gltf.quad();
    for (bool explicitMaterial : {false, true}) {
        if (explicitMaterial) {
            gltf.root["materials"] = {json::object()};
            gltf.primitive()["material"] = 0;
        }
        const Scene scene = load();
        const Material& m = scene.materials.at(size_t(scene.objects[0].material));
        EXPECT_EQ(m.baseColor, glm::vec4(1.0f));
        EXPECT_EQ(m.metallic, 1.0f);
        EXPECT_EQ(m.roughness, 1.0f);
        EXPECT_EQ(m.normalScale, 1.0f);
        EXPECT_EQ(m.occlusionStrength, 1.0f);
        EXPECT_EQ(m.emissive, glm::vec3(0.0f));
        EXPECT_EQ(m.baseColorImage, -1);
        EXPECT_EQ(m.alphaMode, AlphaMode::opaque);
        EXPECT_EQ(m.alphaCutoff, 0.5f);
        EXPECT_FALSE(m.doubleSided);
        EXPECT_EQ(m.heightImage, -1);
    }
}

TEST_F(GltfMaterials, ExtensionsAreReadWhole)
{
    gltf.quad();
    for (const char* name : {"a.png", "b.png", "c.png"})
        writeText(folder / name, std::string("never decoded: ") + name);
    gltf.root["images"] = {{{"uri", "a.png"}}, {{"uri", "b.png"}}, {{"uri", "c.png"}}};
    gltf.root["textures"] = {{{"source", 0}}, {{"source", 1}}, {{"source", 2}}};
    gltf.material() = {{"extensions",
                        {{"KHR_materials_ior", {{"ior", 1.4}}},
                         {"KHR_materials_specular",
                          {{"specularFactor", 0.3},
                           {"specularColorFactor", {0.1, 2, 0.5}},
                           {"specularTexture", {{"index", 1}}},
                           {"specularColorTexture", {{"index", 2}}}}},
                         {"KHR_materials_anisotropy",
                          {{"anisotropyStrength", 0.7},
                           {"anisotropyRotation", 1.5},
                           {"anisotropyTexture", {{"index", 0}}}}}}}};
    gltf.primitive()["material"] = 0;
    gltf.root["extensionsRequired"] = {"KHR_materials_ior", "KHR_materials_specular",
                                       "KHR_materials_anisotropy"};
    const Material m = load().materials.at(0);
    EXPECT_FLOAT_EQ(m.ior, 1.4f);
    EXPECT_FLOAT_EQ(m.specular, 0.3f);
    EXPECT_EQ(m.specularColor, glm::vec3(0.1f, 2.0f, 0.5f));
    EXPECT_EQ(m.specularImage, 1);
    EXPECT_EQ(m.specularColorImage, 2);
    EXPECT_FLOAT_EQ(m.anisotropy, 0.7f);
    EXPECT_FLOAT_EQ(m.anisotropyRotation, 1.5f);
    EXPECT_EQ(m.anisotropyImage, 0);
    gltf.material()["extensions"]["KHR_materials_ior"]["ior"] = 0.5;
    expectRefused(gltf.writeGltf(folder), "ior below 1");
    gltf.material()["extensions"]["KHR_materials_ior"]["ior"] = "glass";
    expectRefused(gltf.writeGltf(folder), "ior is not a number");
}

TEST_F(GltfMaterials, SpecularGlossinessReplacesItsFallback)
{
    gltf.quad();
    for (const char* name : {"a.png", "b.png"})
        writeText(folder / name, "never decoded");
    gltf.root["images"] = {{{"uri", "a.png"}}, {{"uri", "b.png"}}};
    gltf.root["textures"] = {{{"source", 0}}, {{"source", 1}}};
    gltf.material() = {
        {"pbrMetallicRoughness", {{"metallicFactor", 1}, {"baseColorTexture", {{"index", 1}}}}},
        {"extensions",
         {{"KHR_materials_pbrSpecularGlossiness",
           {{"diffuseFactor", {0.1, 0.2, 0.3, 0.4}},
            {"specularFactor", {0.5, 0.6, 0.7}},
            {"glossinessFactor", 0.8},
            {"diffuseTexture", {{"index", 0}}},
            {"specularGlossinessTexture", {{"index", 1}}}}}}}};
    gltf.primitive()["material"] = 0;
    const Material m = load().materials.at(0);
    EXPECT_TRUE(m.specularGlossiness);
    EXPECT_EQ(m.baseColor, glm::vec4(0.1f, 0.2f, 0.3f, 0.4f));
    EXPECT_EQ(m.specularColor, glm::vec3(0.5f, 0.6f, 0.7f));
    EXPECT_FLOAT_EQ(m.glossiness, 0.8f);
    EXPECT_EQ(m.metallic, 0.0f);
    EXPECT_EQ(m.baseColorImage, 0);
    EXPECT_EQ(m.metallicRoughnessImage, 1);
}

TEST_F(GltfMaterials, UnlitEmitsItsBaseColour)
{
    gltf.quad();
    writeText(folder / "a.png", "never decoded");
    gltf.root["images"] = {{{"uri", "a.png"}}};
    gltf.root["textures"] = {{{"source", 0}}};
    gltf.material() = {{"pbrMetallicRoughness",
                        {{"baseColorFactor", {0.1, 0.2, 0.3, 1}}, {"baseColorTexture", {{"index", 0}}}}},
                       {"normalTexture", {{"index", 0}}},
                       {"occlusionTexture", {{"index", 0}}},
                       {"emissiveFactor", {1, 1, 1}},
                       {"extensions",
                        {{"KHR_materials_unlit", json::object()},
                         {"KHR_materials_emissive_strength", {{"emissiveStrength", 8}}}}}};
    gltf.primitive()["material"] = 0;
    const Material m = load().materials.at(0);
    EXPECT_TRUE(m.unlit);
    EXPECT_EQ(m.emissive, glm::vec3(0.1f, 0.2f, 0.3f));
    EXPECT_EQ(m.emissiveImage, 0);
    EXPECT_EQ(m.normalImage, -1);
    EXPECT_EQ(m.occlusionImage, -1);
}

TEST_F(GltfMaterials, WebpIsPreferredAndBasisBecomesNeutral)
{
    gltf.quad();
    for (const char* name : {"a.png", "a.webp", "a.ktx2"})
        writeText(folder / name, "never decoded");
    gltf.root["images"] = {{{"uri", "a.png"}}, {{"uri", "a.webp"}}, {{"uri", "a.ktx2"}}};
    gltf.root["textures"] = {{{"source", 0}, {"extensions", {{"EXT_texture_webp", {{"source", 1}}}}}},
                             {{"extensions", {{"KHR_texture_basisu", {{"source", 2}}}}}}};
    gltf.root["extensionsRequired"] = {"EXT_texture_webp", "KHR_texture_basisu"};
    const json basis = {{"index", 1}};
    gltf.material() = {
        {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}, {"metallicRoughnessTexture", basis}}},
        {"normalTexture", basis},
        {"emissiveTexture", basis},
        {"emissiveFactor", {1, 1, 1}}};
    gltf.primitive()["material"] = 0;
    const Material m = load().materials.at(0);
    EXPECT_EQ(m.baseColorImage, 1);
    EXPECT_EQ(m.normalImage, -1);
    EXPECT_EQ(m.metallicRoughnessImage, -1);
    EXPECT_EQ(m.metallic, 0.0f);
    EXPECT_EQ(m.emissive, glm::vec3(0.0f));
    gltf.root["textures"][0]["extensions"]["EXT_texture_webp"]["source"] = 7;
    expectRefused(gltf.writeGltf(folder), "image 7");
}

TEST_F(GltfMaterials, HeightMapsComeFromOurExtras)
{
    gltf.quad();
    writeText(folder / "h.png", "height");
    gltf.root["images"] = {{{"uri", "h.png"}}};
    gltf.root["textures"] = {{{"source", 0}}};
    gltf.material() = {
        {"extras", {{"lumel", {{"heightTexture", {{"index", 0}}}, {"heightScale", 0.02}, {"power", 300}}}}}};
    gltf.primitive()["material"] = 0;
    const Material m = load().materials.at(0);
    EXPECT_EQ(m.heightImage, 0);
    EXPECT_FLOAT_EQ(m.heightScale, 0.02f);
    EXPECT_FLOAT_EQ(m.power, 300.0f);
    gltf.material()["extras"]["lumel"].erase("heightScale");
    expectRefused(gltf.writeGltf(folder), "heightScale");
}

TEST_F(GltfMaterials, EmbeddedImagesAreCopiedOut)
{
    gltf.quad();
    const size_t view = gltf.view("PNG bytes", 9);
    gltf.root["images"] = {{{"bufferView", view}, {"mimeType", "image/png"}},
                           {{"uri", "data:image/webp;base64," + base64("WebP bytes")}}};
    const std::filesystem::path file = gltf.writeGlb(folder);
    const Scene scene = loadGltf(file);
    const auto text = [&](size_t i) {
        return std::string(reinterpret_cast<const char*>(scene.images.at(i).bytes.data()),
                           scene.images[i].bytes.size());
    };
    EXPECT_EQ(text(0), "PNG bytes");
    EXPECT_EQ(text(1), "WebP bytes");
    EXPECT_EQ(scene.images[0].name, file.string() + "#image0");
}

TEST_F(GltfMaterials, WhatIsNotDrawnYetDoesNotStopLoading)
{
    gltf.quad();
    gltf.root["extensionsUsed"] = {"KHR_materials_clearcoat", "EXT_unheard_of"};
    gltf.root["skins"] = {{{"joints", {0}}}};
    auto& attributes = gltf.primitive()["attributes"];
    attributes["COLOR_0"] = attributes["POSITION"];
    attributes["TEXCOORD_1"] = attributes["TEXCOORD_0"];
    gltf.primitive()["targets"] = {{{"POSITION", 0}}};
    gltf.node()["skin"] = 0;
    EXPECT_EQ(load().objects.size(), 1u);
}

} // namespace
} // namespace lumel::scene
