// glTF materials and images.
#include "gltf_reader.h"

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
        chooseUvs();
        const auto& pbr = in_.pbrMetallicRoughness;
        for (int c = 0; c < 4 && pbr.baseColorFactor.size() == 4; ++c)
            out_.baseColor[c] = factor(pbr.baseColorFactor[size_t(c)], 1.0f, "baseColorFactor");
        out_.metallic = factor(pbr.metallicFactor, 1.0f, "metallicFactor");
        out_.roughness = factor(pbr.roughnessFactor, 1.0f, "roughnessFactor");
        out_.baseColorImage = image(pbr.baseColorTexture, "baseColorTexture");
        out_.metallicRoughnessImage = image(pbr.metallicRoughnessTexture, "metallicRoughnessTexture");
        out_.normalImage = image(in_.normalTexture, "normalTexture");
        out_.normalScale = finite(in_.normalTexture.scale, "normalTexture.scale");
        out_.occlusionImage = image(in_.occlusionTexture, "occlusionTexture");
        out_.occlusionStrength = factor(in_.occlusionTexture.strength, 1.0f, "occlusionTexture.strength");
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
        out_.uv = normal ? *normal : base ? *base : metal.value_or(UvMapping{});
        out_.glowUv = occlusion ? *occlusion : emissive.value_or(out_.uv);
        out_.baseColorUv = base.value_or(out_.uv);
        out_.metallicRoughnessUv = metal.value_or(out_.uv);
        out_.emissiveUv = emissive.value_or(out_.glowUv);
        sayUnlike(out_.uv, out_.baseColorUv, "baseColorTexture");
        sayUnlike(out_.uv, out_.metallicRoughnessUv, "metallicRoughnessTexture");
        sayUnlike(out_.glowUv, out_.emissiveUv, "emissiveTexture");
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

    glm::vec2 pair(const tinygltf::Value& transform, const char* name, glm::vec2 usual) const
    {
        if (!transform.Has(name))
            return usual;
        const tinygltf::Value& value = transform.Get(name);
        if (!value.IsArray() || value.ArrayLen() != 2)
            reader_.fail(fmt::format("material '{}': KHR_texture_transform.{} is not a pair of numbers",
                                     out_.name, name));
        return {number(value.Get(0), name), number(value.Get(1), name)};
    }

    int imageOfTexture(int index, const char* what) const
    {
        if (index < 0 || size_t(index) >= reader_.model.textures.size())
            reader_.fail(fmt::format("material '{}' names texture {} as {}, which does not exist", out_.name,
                                     index, what));
        const int source = reader_.model.textures[size_t(index)].source;
        if (source < 0) { // the image is in an extension, and those are named in the log
            reader_.document.ignored.insert("textures without a PNG or JPEG image");
            return -1;
        }
        if (size_t(source) >= reader_.document.images.size())
            reader_.fail(fmt::format("texture {} names image {}, which does not exist", index, source));
        return source;
    }

    void readEmission()
    {
        float strength = 1.0f;
        const auto extension = in_.extensions.find("KHR_materials_emissive_strength");
        if (extension != in_.extensions.end() && extension->second.Has("emissiveStrength"))
            strength = number(extension->second.Get("emissiveStrength"), "emissiveStrength");
        for (int c = 0; c < 3 && in_.emissiveFactor.size() == 3; ++c)
            out_.emissive[c] =
                std::max(strength, 0.0f) * factor(in_.emissiveFactor[size_t(c)], 1.0f, "emissiveFactor");
        for (int c = 0; c < 3; ++c)
            finite(out_.emissive[c], "emissiveStrength");
        out_.emissiveImage = image(in_.emissiveTexture, "emissiveTexture");
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

    float number(const tinygltf::Value& value, const char* what) const
    {
        if (!value.IsNumber())
            reader_.fail(fmt::format("material '{}': {} is not a number", out_.name, what));
        return finite(value.GetNumberAsDouble(), what);
    }

    Reader& reader_;
    const tinygltf::Material& in_;
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
