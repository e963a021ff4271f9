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
        if (info.index < 0)
            return -1;
        if (info.texCoord != 0)
            reader_.document.ignored.insert("further UV sets");
        return imageOfTexture(info.index, what);
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
