#include "material.h"
#include <cmath>

namespace lumel::judge {
namespace {

const tinygltf::Value& extensionOf(const tinygltf::Material& material, const char* name)
{
    static const tinygltf::Value none;
    const auto found = material.extensions.find(name);
    return found == material.extensions.end() ? none : found->second;
}

float numberOf(const tinygltf::Value& values, const char* name, float fallback)
{
    return values.Has(name) ? float(values.Get(name).GetNumberAsDouble()) : fallback;
}

glm::vec4 coloursOf(const tinygltf::Value& values, const char* name, int count)
{
    glm::vec4 colour(1.0f);
    for (int c = 0; values.Has(name) && c < count; ++c)
        colour[c] = float(values.Get(name).Get(c).GetNumberAsDouble());
    return colour;
}

void readSpecularGlossiness(const tinygltf::Model& model, const tinygltf::Value& values, Material& out)
{
    const glm::vec4 diffuse = coloursOf(values, "diffuseFactor", 4);
    out.factors.baseColour = diffuse;
    out.alpha = diffuse.a;
    out.baseColour = readTexture(model, values, "diffuseTexture", Encoding::srgb);
    out.metallicRoughness = readTexture(model, values, "specularGlossinessTexture", Encoding::srgb);
    out.factors.specularColour = coloursOf(values, "specularFactor", 3);
    out.factors.roughness = numberOf(values, "glossinessFactor", 1.0f); // before the texture
    out.factors.specularGlossiness = true;
}

void readMetallicRoughness(const tinygltf::Model& model, const tinygltf::Material& in, Material& out)
{
    const auto& pbr = in.pbrMetallicRoughness;
    for (int c = 0; c < 3; ++c)
        out.factors.baseColour[c] = float(pbr.baseColorFactor[size_t(c)]);
    out.alpha = float(pbr.baseColorFactor[3]);
    out.factors.metallic = float(pbr.metallicFactor);
    out.factors.roughness = float(pbr.roughnessFactor);
    const auto &base = pbr.baseColorTexture, &rough = pbr.metallicRoughnessTexture;
    out.baseColour = readTexture(model, base.index, base.texCoord, base.extensions, Encoding::srgb);
    out.metallicRoughness =
        readTexture(model, rough.index, rough.texCoord, rough.extensions, Encoding::linear);
    out.factors.ior = numberOf(extensionOf(in, "KHR_materials_ior"), "ior", 1.5f);
    const tinygltf::Value& specular = extensionOf(in, "KHR_materials_specular");
    out.factors.specular = numberOf(specular, "specularFactor", 1.0f);
    out.factors.specularColour = coloursOf(specular, "specularColorFactor", 3);
    out.specular = readTexture(model, specular, "specularTexture", Encoding::linear);
    out.specularColour = readTexture(model, specular, "specularColorTexture", Encoding::srgb);
}

} // namespace

Material readMaterial(const tinygltf::Model& model, int index)
{
    Material out;
    if (index < 0)
        return out;
    const tinygltf::Material& in = model.materials.at(size_t(index));
    const tinygltf::Value& glossy = extensionOf(in, "KHR_materials_pbrSpecularGlossiness");
    if (glossy.IsObject())
        readSpecularGlossiness(model, glossy, out);
    else
        readMetallicRoughness(model, in, out);
    const auto& normal = in.normalTexture;
    out.normal = readTexture(model, normal.index, normal.texCoord, normal.extensions, Encoding::linear);
    out.normalScale = float(normal.scale);
    const auto& occlusion = in.occlusionTexture;
    out.occlusion =
        readTexture(model, occlusion.index, occlusion.texCoord, occlusion.extensions, Encoding::linear);
    out.occlusionStrength = float(occlusion.strength);
    const auto& emissive = in.emissiveTexture;
    out.emission = readTexture(model, emissive.index, emissive.texCoord, emissive.extensions, Encoding::srgb);
    const float strength =
        numberOf(extensionOf(in, "KHR_materials_emissive_strength"), "emissiveStrength", 1.0f);
    for (int c = 0; c < 3; ++c)
        out.emissive[c] = float(in.emissiveFactor[size_t(c)]) * strength;
    const tinygltf::Value& anisotropy = extensionOf(in, "KHR_materials_anisotropy");
    out.factors.anisotropy = numberOf(anisotropy, "anisotropyStrength", 0.0f);
    out.anisotropyRotation = numberOf(anisotropy, "anisotropyRotation", 0.0f);
    out.anisotropy = readTexture(model, anisotropy, "anisotropyTexture", Encoding::linear);
    out.mode = in.alphaMode == "MASK" ? Alpha::mask : in.alphaMode == "BLEND" ? Alpha::blend : Alpha::opaque;
    out.cutoff = float(in.alphaCutoff);
    out.doubleSided = in.doubleSided;
    out.unlit = in.extensions.count("KHR_materials_unlit") > 0;
    return out;
}

float Material::alphaAt(const glm::dvec2 uv[2], float colourAlpha) const
{
    return mode == Alpha::opaque ? 1.0f : alpha * colourAlpha * baseColour(uv).a;
}

Parameters Material::parametersAt(const glm::dvec2 uv[2], glm::vec3 colour) const
{
    Parameters p = factors;
    p.baseColour *= glm::vec3(baseColour(uv)) * colour;
    const glm::vec4 rough = metallicRoughness(uv);
    if (p.specularGlossiness) {
        p.specularColour *= glm::vec3(rough);
        p.roughness = 1.0f - p.roughness * rough.a;
    } else {
        p.roughness *= rough.g;
        p.metallic *= rough.b;
        p.specular *= specular(uv).a;
        p.specularColour *= glm::vec3(specularColour(uv));
    }
    // KHR_materials_anisotropy: direction in red and green, strength in blue; without a texture (1, 0) and 1.
    glm::vec2 direction(1.0f, 0.0f);
    if (!anisotropy.empty()) {
        const glm::vec4 texel = anisotropy(uv);
        direction = glm::normalize(2.0f * glm::vec2(texel) - 1.0f);
        p.anisotropy *= texel.b;
    }
    const float c = std::cos(anisotropyRotation), s = std::sin(anisotropyRotation);
    p.anisotropyDirection = {c * direction.x - s * direction.y, s * direction.x + c * direction.y};
    return p;
}

glm::vec3 Material::normalAt(const glm::dvec2 uv[2]) const
{
    if (normal.empty())
        return {0.0f, 0.0f, 1.0f};
    return glm::normalize((2.0f * glm::vec3(normal(uv)) - 1.0f) * glm::vec3(normalScale, normalScale, 1.0f));
}

float Material::occlusionAt(const glm::dvec2 uv[2]) const
{
    return occlusion.empty() ? 1.0f : 1.0f + occlusionStrength * (occlusion(uv).r - 1.0f);
}

glm::vec3 Material::emissionAt(const glm::dvec2 uv[2]) const
{
    return emissive * glm::vec3(emission(uv));
}

const Texture& Material::tangentTexture() const
{
    return normal.empty() && !anisotropy.empty() ? anisotropy : normal.empty() ? baseColour : normal;
}

} // namespace lumel::judge
