// glTF materials and images.
#include "reader.h"
#include "uri.h"

namespace lumel::scene {
namespace {

class MaterialReader {
public:
    MaterialReader(Reader& reader, size_t index) : reader_(reader), in_(reader.model.materials[index])
    {
        out_.name = in_.name.empty() ? fmt::format("material {}", index) : printable(in_.name);
    }

    Material read()
    {
        adoptSpecularGlossiness();
        adoptUnlit();
        chooseUvs();
        const auto& pbr = in_.pbrMetallicRoughness;
        for (int c = 0; c < 4 && pbr.baseColorFactor.size() == 4; ++c)
            out_.baseColor[c] = factor(pbr.baseColorFactor[size_t(c)], 1.0f, "baseColorFactor");
        out_.metallic = factor(pbr.metallicFactor, 1.0f, "metallicFactor");
        out_.roughness = factor(pbr.roughnessFactor, 1.0f, "roughnessFactor");
        out_.baseColorImage = image(pbr.baseColorTexture, "baseColorTexture");
        out_.metallicRoughnessImage = image(pbr.metallicRoughnessTexture, "metallicRoughnessTexture");
        if (pbr.metallicRoughnessTexture.index >= 0 && out_.metallicRoughnessImage < 0)
            out_.metallic = 0.0f; // the factor 1 stands for the missing image
        out_.normalImage = image(in_.normalTexture, "normalTexture");
        out_.normalScale = finite(in_.normalTexture.scale, "normalTexture.scale");
        out_.occlusionImage = image(in_.occlusionTexture, "occlusionTexture");
        out_.occlusionStrength = factor(in_.occlusionTexture.strength, 1.0f, "occlusionTexture.strength");
        readDielectric();
        readAnisotropy();
        readEmission();
        readAlpha();
        out_.doubleSided = in_.doubleSided;
        readHeight();
        return out_;
    }

private:
    float finite(double value, const char* what) const
    {
        if (!std::isfinite(float(value)))
            reader_.fail(fmt::format("material '{}' has a {} out of range", out_.name, what));
        return float(value);
    }
    // Values outside of the specification's range are common enough to be clamped.
    float factor(double value, float upper, const char* what) const
    {
        return std::clamp(finite(value, what), 0.0f, upper);
    }

    template<class TextureInfo>
    int image(const TextureInfo& info, const char* what) const
    {
        return info.index < 0 ? -1 : imageOfTexture(info.index, what);
    }

    // Of each kind the first map that there is sets where all of them are read.
    void chooseUvs()
    {
        const auto& pbr = in_.pbrMetallicRoughness;
        const auto normal = mapping(in_.normalTexture), base = mapping(pbr.baseColorTexture),
                   metal = mapping(pbr.metallicRoughnessTexture), occlusion = mapping(in_.occlusionTexture),
                   emissive = mapping(in_.emissiveTexture);
        const auto specular = mapping(textureOf(extension("KHR_materials_specular"), "specularTexture")),
                   specularColor =
                       mapping(textureOf(extension("KHR_materials_specular"), "specularColorTexture")),
                   anisotropy =
                       mapping(textureOf(extension("KHR_materials_anisotropy"), "anisotropyTexture"));
        out_.uv = UvMapping{};
        for (const auto& first : {normal, base, metal, specular, specularColor, anisotropy})
            if (first) {
                out_.uv = *first;
                break;
            }
        out_.emissionUv = occlusion ? *occlusion : emissive.value_or(out_.uv);
        out_.baseColorUv = base.value_or(out_.uv);
        out_.metallicRoughnessUv = metal.value_or(out_.uv);
        out_.specularUv = specular.value_or(out_.uv);
        out_.specularColorUv = specularColor.value_or(out_.uv);
        out_.anisotropyUv = anisotropy.value_or(out_.uv);
        out_.emissiveUv = emissive.value_or(out_.emissionUv);
        sayUnlike(out_.uv, out_.baseColorUv, "baseColorTexture");
        sayUnlike(out_.uv, out_.metallicRoughnessUv, "metallicRoughnessTexture");
        sayUnlike(out_.uv, out_.specularUv, "specularTexture");
        sayUnlike(out_.uv, out_.specularColorUv, "specularColorTexture");
        sayUnlike(out_.uv, out_.anisotropyUv, "anisotropyTexture");
        sayUnlike(out_.emissionUv, out_.emissiveUv, "emissiveTexture");
    }

    // Another UV set or wrap mode cannot be baked into one map with the others; a transform can, but beyond
    // [0, 1] only if both repeat together.
    void sayUnlike(const UvMapping& common, const UvMapping& own, const char* what) const
    {
        bool alike = own.set == common.set && own.wrapU == common.wrapU && own.wrapV == common.wrapV;
        const auto relative = mappingBetween(common, own);
        for (int i = 0; i < 4 && alike; ++i) {
            const float entry = relative ? (*relative)[i / 2][i % 2] : 0.5f;
            alike = std::abs(entry - std::round(entry)) < 1e-3f;
        }
        if (!alike)
            reader_.document.ignored.insert(
                fmt::format("texture coordinates of {} unlike those of the material's other maps", what));
    }

    static Wrap wrapOf(int mode)
    {
        return mode == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE     ? Wrap::clamp
               : mode == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT ? Wrap::mirror
                                                               : Wrap::repeat;
    }

    // Nothing where there is no texture.
    template<class TextureInfo>
    std::optional<UvMapping> mapping(const TextureInfo& info) const
    {
        if (info.index < 0 || size_t(info.index) >= reader_.model.textures.size())
            return std::nullopt;
        UvMapping m;
        m.set = info.texCoord;
        const int sampler = reader_.model.textures[size_t(info.index)].sampler;
        if (sampler >= 0 && size_t(sampler) < reader_.model.samplers.size()) {
            m.wrapU = wrapOf(reader_.model.samplers[size_t(sampler)].wrapS);
            m.wrapV = wrapOf(reader_.model.samplers[size_t(sampler)].wrapT);
        }
        const auto found = info.extensions.find("KHR_texture_transform");
        if (found != info.extensions.end() && found->second.IsObject()) {
            const tinygltf::Value& transform = found->second;
            m.offset = pair(transform, "offset", m.offset);
            m.scale = pair(transform, "scale", m.scale);
            if (transform.Has("rotation"))
                m.rotation = number(transform.Get("rotation"), "KHR_texture_transform.rotation");
            if (transform.Has("texCoord"))
                m.set = int(number(transform.Get("texCoord"), "KHR_texture_transform.texCoord"));
        }
        if (m.set != 0 && m.set != 1) {
            reader_.document.ignored.insert("further UV sets");
            m.set = 0;
        }
        return m;
    }

    glm::vec2 pair(const tinygltf::Value& transform, const char* name, glm::vec2 fallback) const
    {
        if (!transform.Has(name))
            return fallback;
        const tinygltf::Value& value = transform.Get(name);
        if (!value.IsArray() || value.ArrayLen() != 2)
            reader_.fail(fmt::format("material '{}': KHR_texture_transform.{} is not a pair of numbers",
                                     out_.name, name));
        return {number(value.Get(0), name), number(value.Get(1), name)};
    }

    // An extension's members, empty when the material lacks it.
    const tinygltf::Value& extension(const char* name) const
    {
        static const tinygltf::Value none;
        const auto found = in_.extensions.find(name);
        return found == in_.extensions.end() ? none : found->second;
    }

    float numberOf(const tinygltf::Value& values, const char* key, float fallback) const
    {
        return values.Has(key) ? number(values.Get(key), key) : fallback;
    }

    std::vector<double> numbersOf(const tinygltf::Value& values, const char* key, size_t count) const
    {
        if (!values.Has(key))
            return std::vector<double>(count, 1.0);
        const tinygltf::Value& array = values.Get(key);
        if (!array.IsArray() || array.ArrayLen() != count)
            reader_.fail(fmt::format("material '{}': {} is not {} numbers", out_.name, key, count));
        std::vector<double> numbers;
        for (size_t i = 0; i < count; ++i)
            numbers.push_back(number(array.Get(int(i)), key));
        return numbers;
    }

    tinygltf::TextureInfo textureOf(const tinygltf::Value& values, const char* key) const
    {
        tinygltf::TextureInfo info;
        if (!values.Has(key))
            return info;
        const tinygltf::Value& texture = values.Get(key);
        if (!texture.Has("index") || !texture.Get("index").IsInt())
            reader_.fail(fmt::format("material '{}': {} has no index", out_.name, key));
        info.index = texture.Get("index").GetNumberAsInt();
        if (texture.Has("texCoord") && texture.Get("texCoord").IsInt())
            info.texCoord = texture.Get("texCoord").GetNumberAsInt();
        if (texture.Has("extensions") && texture.Get("extensions").IsObject())
            info.extensions = texture.Get("extensions").Get<tinygltf::Value::Object>();
        return info;
    }

    // Its textures take the places of the metallic-roughness ones, which are its fallback.
    void adoptSpecularGlossiness()
    {
        const tinygltf::Value& values = extension("KHR_materials_pbrSpecularGlossiness");
        if (!values.IsObject())
            return;
        auto& pbr = in_.pbrMetallicRoughness;
        pbr.baseColorFactor = numbersOf(values, "diffuseFactor", 4);
        pbr.baseColorTexture = textureOf(values, "diffuseTexture");
        pbr.metallicRoughnessTexture = textureOf(values, "specularGlossinessTexture");
        pbr.metallicFactor = 0.0;
        const auto specular = numbersOf(values, "specularFactor", 3);
        for (int c = 0; c < 3; ++c)
            out_.specularColor[c] = factor(specular[size_t(c)], 1.0f, "specularFactor");
        out_.glossiness = std::clamp(numberOf(values, "glossinessFactor", 1.0f), 0.0f, 1.0f);
        out_.specularGlossiness = true;
    }

    // What is not lit is what the surface emits.
    void adoptUnlit()
    {
        out_.unlit = in_.extensions.contains("KHR_materials_unlit");
        if (!out_.unlit)
            return;
        const auto& pbr = in_.pbrMetallicRoughness;
        in_.emissiveFactor = {1.0, 1.0, 1.0};
        for (size_t c = 0; c < 3 && pbr.baseColorFactor.size() == 4; ++c)
            in_.emissiveFactor[c] = pbr.baseColorFactor[c];
        in_.emissiveTexture = pbr.baseColorTexture;
        in_.extensions.erase("KHR_materials_emissive_strength");
        in_.normalTexture = {};
        in_.occlusionTexture = {};
    }

    void readDielectric()
    {
        if (out_.specularGlossiness)
            return;
        out_.ior = numberOf(extension("KHR_materials_ior"), "ior", 1.5f);
        if (out_.ior != 0.0f && out_.ior < 1.0f)
            reader_.fail(fmt::format("material '{}' has an ior below 1", out_.name));
        const tinygltf::Value& values = extension("KHR_materials_specular");
        out_.specular = std::clamp(numberOf(values, "specularFactor", 1.0f), 0.0f, 1.0f);
        const auto colour = numbersOf(values, "specularColorFactor", 3);
        for (int c = 0; c < 3; ++c) // may exceed 1
            out_.specularColor[c] = std::max(finite(colour[size_t(c)], "specularColorFactor"), 0.0f);
        out_.specularImage = image(textureOf(values, "specularTexture"), "specularTexture");
        out_.specularColorImage = image(textureOf(values, "specularColorTexture"), "specularColorTexture");
    }

    void readAnisotropy()
    {
        const tinygltf::Value& values = extension("KHR_materials_anisotropy");
        out_.anisotropy = std::clamp(numberOf(values, "anisotropyStrength", 0.0f), 0.0f, 1.0f);
        out_.anisotropyRotation = numberOf(values, "anisotropyRotation", 0.0f);
        out_.anisotropyImage = image(textureOf(values, "anisotropyTexture"), "anisotropyTexture");
    }

    int imageOfTexture(int index, const char* what) const
    {
        if (index < 0 || size_t(index) >= reader_.model.textures.size())
            reader_.fail(fmt::format("material '{}' names texture {} as {}, which does not exist", out_.name,
                                     index, what));
        const tinygltf::Texture& texture = reader_.model.textures[size_t(index)];
        int source = texture.source;
        const auto webp = texture.extensions.find("EXT_texture_webp");
        if (webp != texture.extensions.end() && webp->second.Has("source") &&
            webp->second.Get("source").IsInt())
            source = webp->second.Get("source").GetNumberAsInt();
        if (source < 0) {
            reader_.document.ignored.insert(texture.extensions.contains("KHR_texture_basisu")
                                                ? "KHR_texture_basisu textures (convert them to PNG)"
                                                : "textures without an image");
            return -1;
        }
        if (size_t(source) >= reader_.document.images.size())
            reader_.fail(fmt::format("texture {} names image {}, which does not exist", index, source));
        return source;
    }

    void readEmission()
    {
        const float strength =
            numberOf(extension("KHR_materials_emissive_strength"), "emissiveStrength", 1.0f);
        for (int c = 0; c < 3 && in_.emissiveFactor.size() == 3; ++c)
            out_.emissive[c] =
                std::max(strength, 0.0f) * factor(in_.emissiveFactor[size_t(c)], 1.0f, "emissiveFactor");
        for (int c = 0; c < 3; ++c)
            finite(out_.emissive[c], "emissiveStrength");
        out_.emissiveImage = image(in_.emissiveTexture, "emissiveTexture");
        if (in_.emissiveTexture.index >= 0 && out_.emissiveImage < 0 && !out_.unlit)
            out_.emissive = glm::vec3(0.0f); // most of a missing image is dark
    }

    void readAlpha()
    {
        if (in_.alphaMode == "MASK")
            out_.alphaMode = AlphaMode::mask;
        else if (in_.alphaMode == "BLEND")
            out_.alphaMode = AlphaMode::blend;
        out_.alphaCutoff = std::max(finite(in_.alphaCutoff, "alphaCutoff"), 0.0f);
    }

    // extras.lumel, as scene.h documents it.
    void readHeight()
    {
        if (!in_.extras.Has("lumel"))
            return;
        const tinygltf::Value& ours = in_.extras.Get("lumel");
        if (!ours.IsObject())
            reader_.fail(fmt::format("material '{}': extras.lumel is not an object", out_.name));
        if (ours.Has("power"))
            out_.power = std::max(number(ours.Get("power"), "extras.lumel.power"), 0.0f);
        readBaked(ours);
        if (!ours.Has("heightTexture"))
            return;
        const tinygltf::Value& texture = ours.Get("heightTexture");
        if (!texture.Has("index") || !texture.Get("index").IsInt())
            reader_.fail(fmt::format("material '{}': extras.lumel.heightTexture has no index", out_.name));
        out_.heightImage =
            imageOfTexture(texture.Get("index").GetNumberAsInt(), "extras.lumel.heightTexture");
        if (!ours.Has("heightScale"))
            reader_.fail(
                fmt::format("material '{}': extras.lumel has a heightTexture without heightScale", out_.name),
                "add it");
        out_.heightScale = number(ours.Get("heightScale"), "extras.lumel.heightScale");
    }

    // What `lumel bake` wrote beside the model. Without it, the maps are baked.
    void readBaked(const tinygltf::Value& ours)
    {
        if (!ours.Has("baked"))
            return;
        if (!ours.Get("baked").IsString())
            reader_.fail(fmt::format("material '{}': extras.lumel.baked is not a file's name", out_.name));
        const std::filesystem::path model(reader_.document.file);
        out_.ownChain =
            resolveUri(reader_.document.file, model.parent_path(), ours.Get("baked").Get<std::string>());
        if (!std::filesystem::exists(out_.ownChain)) {
            reader_.document.ignored.insert("baked materials that are not beside the model");
            out_.ownChain.clear();
        } else if (ours.Has("maps") && ours.Get("maps").IsString()) {
            out_.ownMaps = ours.Get("maps").Get<std::string>();
        }
    }

    float number(const tinygltf::Value& value, const char* what) const
    {
        if (!value.IsNumber())
            reader_.fail(fmt::format("material '{}': {} is not a number", out_.name, what));
        return finite(value.GetNumberAsDouble(), what);
    }

    Reader& reader_;
    tinygltf::Material in_; // a copy: extensions replace parts of it
    Material out_;
};

} // namespace

void readMaterials(Reader& reader, Scene& scene)
{
    for (size_t i = 0; i < reader.model.materials.size(); ++i)
        scene.materials.push_back(MaterialReader(reader, i).read());
}

void readImages(Reader& reader, Scene& scene)
{
    for (ImageSource& source : reader.document.images) {
        SceneImage image;
        image.name = source.name;
        if (source.bufferView >= 0) {
            const auto bytes = bufferViewBytes(reader, source.bufferView);
            image.bytes.assign(bytes.begin(), bytes.end());
        } else {
            image.bytes = std::move(source.bytes);
        }
        if (image.bytes.empty())
            reader.fail(fmt::format("image {} is empty", image.name));
        scene.images.push_back(std::move(image));
    }
}

} // namespace lumel::scene
