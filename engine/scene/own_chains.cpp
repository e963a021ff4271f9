#include "own_chains.h"
#include "core/file.h"
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

namespace lumel::scene {
namespace {

// Fields by name, those at their defaults left out.
class NamedFields {
public:
    explicit NamedFields(std::span<const std::string> imageHashes) : imageHashes_(imageHashes) {}

    template<class T>
    void add(const char* name, const T& value, const T& standard)
    {
        if (value != standard)
            hash_.add(std::string(name)).addValue(value);
    }
    void add(const char* name, int image)
    {
        if (image >= 0)
            hash_.add(std::string(name)).add(imageHashes_[size_t(image)]);
    }
    // Where another image than the first of its kind is read: where all are read may change.
    void add(const char* name, int image, const UvMapping& own, const UvMapping& common)
    {
        add(name, image);
        if (image < 0 || own == common)
            return;
        for (const UvMapping* uv : {&own, &common})
            hash_.addValue(uv->set).addValue(uv->offset).addValue(uv->scale).addValue(uv->rotation);
        hash_.addValue(own.wrapU).addValue(own.wrapV);
    }
    std::string hex() const { return hash_.hex(); }

private:
    std::span<const std::string> imageHashes_;
    ContentHash hash_;
};

// What is asked for and a chain is not: "method average in place of fit"; empty: nothing.
std::string contradiction(const baker::ReflectanceMips& chain, const MaterialOptions& options)
{
    std::vector<std::string> words;
    const auto compare = [&](bool asked, const char* what, const std::string& wanted,
                             const std::string& found) {
        if (asked && wanted != found)
            words.push_back(fmt::format("{} {} in place of {}", what, wanted, found));
    };
    compare(options.asked.method, "method", nameOf(options.method), chain.method);
    compare(options.asked.model, "model", nameOf(options.model), chain.model);
    if (options.method == baker::Method::fit && chain.method == nameOf(baker::Method::fit))
        compare(options.asked.lobes, "lobes", nameOf(options.lobes), chain.lobes);
    return fmt::format("{}", fmt::join(words, ", "));
}

// "'a', 'b' and 7 more"
std::string listed(const std::vector<std::string>& names)
{
    constexpr size_t kMost = 3;
    std::string text;
    for (size_t i = 0; i < std::min(names.size(), kMost); ++i)
        text += fmt::format("{}'{}'", i == 0 ? "" : ", ", names[i]);
    return names.size() > kMost ? fmt::format("{} and {} more", text, names.size() - kMost) : text;
}

} // namespace

std::string imageHash(std::span<const std::byte> encoded)
{
    return ContentHash().add(encoded.data(), encoded.size()).addValue(encoded.size()).hex();
}

// Alpha, occlusion and emission are no part of a chain.
std::string mapsHash(const Material& m, std::span<const std::string> imageHashes)
{
    const Material standard;
    NamedFields fields(imageHashes);
    fields.add("baseColor", glm::vec3(m.baseColor), glm::vec3(standard.baseColor));
    fields.add("metallic", m.metallic, standard.metallic);
    fields.add("roughness", m.roughness, standard.roughness);
    fields.add("normalScale", m.normalScale, standard.normalScale);
    fields.add("specularGlossiness", m.specularGlossiness, standard.specularGlossiness);
    fields.add("glossiness", m.glossiness, standard.glossiness);
    fields.add("ior", m.ior, standard.ior);
    fields.add("specular", m.specular, standard.specular);
    fields.add("specularColor", m.specularColor, standard.specularColor);
    fields.add("anisotropy", m.anisotropy, standard.anisotropy);
    fields.add("anisotropyRotation", m.anisotropyRotation, standard.anisotropyRotation);
    fields.add("unlit", m.unlit, standard.unlit);
    fields.add("heightScale", m.heightScale, standard.heightScale);
    fields.add("power", m.power, standard.power);
    fields.add("wrapU", m.uv.wrapU, standard.uv.wrapU);
    fields.add("wrapV", m.uv.wrapV, standard.uv.wrapV);
    fields.add("normalImage", m.normalImage);
    fields.add("heightImage", m.heightImage);
    fields.add("baseColorImage", m.baseColorImage, m.baseColorUv, m.uv);
    fields.add("metallicRoughnessImage", m.metallicRoughnessImage, m.metallicRoughnessUv, m.uv);
    fields.add("specularImage", m.specularImage, m.specularUv, m.uv);
    fields.add("specularColorImage", m.specularColorImage, m.specularColorUv, m.uv);
    fields.add("anisotropyImage", m.anisotropyImage, m.anisotropyUv, m.uv);
    return fields.hex();
}

std::vector<std::filesystem::path> chainsToRead(const Scene& scene, const MaterialOptions& options,
                                                std::span<const std::string> imageHashes)
{
    std::vector<std::filesystem::path> chains;
    std::vector<std::string> changed, unlike;
    std::string why;
    for (const Material& m : scene.materials) {
        chains.push_back(m.bakedFile);
        if (!m.bakedFile.empty() || m.ownChain.empty())
            continue;
        const std::string asked = contradiction(baker::readExrMetadata(m.ownChain), options);
        if (!m.ownMaps.empty() && m.ownMaps != mapsHash(m, imageHashes)) {
            changed.push_back(m.name);
        } else if (!asked.empty()) {
            unlike.push_back(m.name);
            why = asked;
        } else {
            chains.back() = m.ownChain;
        }
    }
    const std::string file = scene.file.string();
    if (!changed.empty())
        spdlog::info(
            "{}: its own chain is not used for {}: textures or factors have changed since lumel bake", file,
            listed(changed));
    if (!unlike.empty())
        spdlog::info("{}: its own chain is not used for {}: {} is asked for", file, listed(unlike), why);
    return chains;
}

} // namespace lumel::scene
