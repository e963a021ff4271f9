// Material extensions, one after the other.
#include "subject.h"

namespace lumel::test {
namespace {

// Parameters that vary do so in steps between fine texels: few samples fall between two, where the judge
// interpolates glTF's parameters and the renderer the reflectances made of them.
void aBall(const std::string& name, Subject& subject, const json& material, const Look& look = {})
{
    subject.place(ball(), material);
    expectAgreement(name, subject, look);
}

json plain(glm::vec3 colour, float metallic, float roughness)
{
    return {{"pbrMetallicRoughness",
             {{"baseColorFactor", {colour.r, colour.g, colour.b, 1.0f}},
              {"metallicFactor", metallic},
              {"roughnessFactor", roughness}}}};
}

TEST_F(Judge, MetallicRoughness)
{
    Subject subject;
    json material = subject.material(patches(256, 8, 1));
    Image map = patches(256, 8, 2);
    for (size_t i = 0; i < map.pixels.size(); ++i)
        map.pixels[i] = i % 3 == 1 ? 0.3f + 0.5f * map.pixels[i] : map.pixels[i];
    material["pbrMetallicRoughness"]["metallicRoughnessTexture"] = info(subject.texture(map));
    material["pbrMetallicRoughness"]["metallicFactor"] = 1.0;
    material["pbrMetallicRoughness"]["roughnessFactor"] = 0.9;
    aBall("metallic-roughness", subject, material);
}

TEST_F(Judge, Metals)
{
    for (const float roughness : {0.25f, 0.6f}) {
        Subject subject;
        aBall(fmt::format("metal-{}", roughness), subject, plain({0.9f, 0.6f, 0.3f}, 1.0f, roughness),
              {.environment = 0.3f});
    }
}

TEST_F(Judge, SpecularGlossiness)
{
    Subject subject;
    subject.use("KHR_materials_pbrSpecularGlossiness");
    json values = {{"diffuseFactor", {0.9, 0.8, 0.7, 1.0}},
                   {"specularFactor", {0.5, 0.6, 0.7}},
                   {"glossinessFactor", 0.8}};
    values["diffuseTexture"] = info(subject.texture(patches(256, 8, 1)));
    Image glossy = patches(256, 8, 2, true);
    for (size_t i = 3; i < glossy.pixels.size(); i += 4)
        glossy.pixels[i] = 0.4f + 0.5f * glossy.pixels[i];
    values["specularGlossinessTexture"] = info(subject.texture(glossy));
    json material = plain({1, 0, 0}, 1.0f, 1.0f); // the fallback
    material["extensions"]["KHR_materials_pbrSpecularGlossiness"] = values;
    aBall("specular-glossiness", subject, material);
}

TEST_F(Judge, Specular)
{
    Subject subject;
    subject.use("KHR_materials_specular");
    subject.use("KHR_materials_ior");
    json material = plain({0.02f, 0.01f, 0.0f}, 0.0f, 0.35f);
    material["extensions"]["KHR_materials_ior"]["ior"] = 2.2; // so that there is much to see
    json& values = material["extensions"]["KHR_materials_specular"];
    Image strength = patches(512, 8, 2, true);
    values["specularFactor"] = 0.9;
    values["specularTexture"] = info(subject.texture(strength));
    values["specularColorFactor"] = {1.5, 1.0, 2.0};
    values["specularColorTexture"] = info(subject.texture(patches(512, 8, 3)));
    aBall("specular", subject, material, {.environment = 0.8f});
}

TEST_F(Judge, Ior)
{
    for (const float ior : {1.0f, 1.33f, 2.4f, 0.0f}) {
        Subject subject;
        subject.use("KHR_materials_ior");
        json material = plain({0.1f, 0.3f, 0.2f}, 0.0f, 0.3f);
        material["extensions"]["KHR_materials_ior"]["ior"] = ior;
        aBall(fmt::format("ior-{}", ior), subject, material, {.environment = 0.2f});
    }
}

TEST_F(Judge, Anisotropy)
{
    for (const bool map : {false, true}) {
        Subject subject;
        subject.use("KHR_materials_anisotropy");
        json material = plain({0.8f, 0.5f, 0.3f}, 1.0f, 0.3f);
        json& values = material["extensions"]["KHR_materials_anisotropy"];
        values["anisotropyStrength"] = 0.7;
        values["anisotropyRotation"] = 0.5;
        if (map) {
            Image directions = patches(4, 4, 9);
            for (int i = 0; i < 16; ++i) {
                const float angle = 0.39f * float(i);
                const glm::vec3 texel(0.5f + 0.5f * std::cos(angle), 0.5f + 0.5f * std::sin(angle),
                                      0.5f + 0.5f * float(i % 2));
                std::copy_n(&texel.x, 3, directions.at(i % 4, i / 4));
            }
            Image large(512, 512, 3);
            for (int y = 0; y < 512; ++y)
                for (int x = 0; x < 512; ++x)
                    std::copy_n(directions.at(x / 128, y / 128), 3, large.at(x, y));
            values["anisotropyTexture"] = info(subject.texture(large));
        }
        aBall(fmt::format("anisotropy-{}", int(map)), subject, material);
    }
}

TEST_F(Judge, EmissiveStrength)
{
    Subject subject;
    subject.use("KHR_materials_emissive_strength");
    json material = subject.material(patches(16, 4, 1));
    material["emissiveFactor"] = {0.5, 0.3, 0.1};
    material["emissiveTexture"] = info(subject.texture(patches(64, 16, 2)));
    material["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] = 4.0;
    aBall("emissive-strength", subject, material);
}

TEST_F(Judge, Unlit)
{
    Subject subject;
    subject.use("KHR_materials_unlit");
    json material = subject.material(patches(64, 16, 1));
    material["pbrMetallicRoughness"]["baseColorFactor"] = {0.9, 0.7, 0.5, 1.0};
    material["extensions"]["KHR_materials_unlit"] = json::object();
    aBall("unlit", subject, material);
}

} // namespace
} // namespace lumel::test
