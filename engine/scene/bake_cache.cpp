#include "bake_cache.h"
#include "core/error.h"
#include "material_maps.h"
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

namespace lumel::scene {
namespace {

constexpr const char* kMapsVersion = "1"; // raise when material_maps.cpp changes its results

std::string fileHash(const std::filesystem::path& file)
{
    const auto bytes = readFile(file);
    return ContentHash().add(bytes.data(), bytes.size()).addValue(bytes.size()).hex();
}

bool isUsable(const Image& glow)
{
    if (glow.empty() || glow.channels != 4)
        return false;
    return std::all_of(glow.pixels.begin(), glow.pixels.end(),
                       [](float value) { return std::isfinite(value); });
}

} // namespace

BakeCache::BakeCache(const Scene& scene, const MaterialOptions& options) : scene_(scene), options_(options)
{
    for (const SceneImage& image : scene.images)
        imageHashes_.push_back(
            ContentHash().add(image.bytes.data(), image.bytes.size()).addValue(image.bytes.size()).hex());
    if (!options.useCache)
        return;
    try {
        folder_ = cacheFolder();
    } catch (const Error& e) {
        spdlog::warn("{}; materials are baked anew each time", e.what());
    }
}

std::string BakeCache::key(const Material& m) const
{
    ContentHash hash;
    hash.add(std::string(baker::kVersion)).add(std::string(kMapsVersion));
    hash.addValue(int(options_.method)).addValue(int(options_.model));
    for (float value : {m.baseColor.x,       m.baseColor.y,
                        m.baseColor.z,       m.metallic,
                        m.roughness,         m.normalScale,
                        m.occlusionStrength, m.emissive.x,
                        m.emissive.y,        m.emissive.z,
                        m.heightScale,       m.power,
                        m.glossiness,        m.ior,
                        m.specular,          m.specularColor.x,
                        m.specularColor.y,   m.specularColor.z,
                        m.anisotropy,        m.anisotropyRotation})
        hash.addValue(value);
    for (int image :
         {m.baseColorImage, m.metallicRoughnessImage, m.normalImage, m.occlusionImage, m.emissiveImage,
          m.heightImage, m.specularImage, m.specularColorImage, m.anisotropyImage})
        hash.add(image < 0 ? std::string("none") : imageHashes_[size_t(image)]);
    hash.addValue(m.specularGlossiness).addValue(m.unlit);
    if (m.uv.wrapU != Wrap::repeat || m.uv.wrapV != Wrap::repeat)
        hash.add(std::string("clamp"));
    for (const auto& [own, common] : {std::pair(m.baseColorUv, m.uv), std::pair(m.metallicRoughnessUv, m.uv),
                                      std::pair(m.emissiveUv, m.glowUv)})
        if (own != common)
            hash.addValue(own.set == common.set)
                .addValue(own.matrix())
                .addValue(common.matrix())
                .addValue(own.wrapU)
                .addValue(own.wrapV);
    return hash.hex();
}

std::filesystem::path BakeCache::path(const std::string& key, const char* ending) const
{
    return *folder_ / (key + ending);
}

std::optional<BakedMaterial> BakeCache::load(const std::string& key, const Material& material) const
{
    if (!folder_ || !std::filesystem::exists(path(key, ".json")))
        return std::nullopt;
    try {
        const auto text = readFile(path(key, ".json"), 4096);
        const char* begin = reinterpret_cast<const char*>(text.data());
        const auto manifest = nlohmann::json::parse(begin, begin + text.size());
        if (manifest.at("key") != key || manifest.at("reflectance") != fileHash(path(key, ".exr")))
            throw Error("the file is not the one that was stored");
        BakedMaterial baked;
        baked.reflectance = baker::readExr(path(key, ".exr"));
        if (baked.reflectance.version != baker::kVersion)
            throw Error("it is of another version");
        if (glowVaries(material)) {
            if (manifest.at("glow") != fileHash(path(key, "-glow.exr")))
                throw Error("the file is not the one that was stored");
            Image glow = readImage(path(key, "-glow.exr"));
            if (!isUsable(glow))
                throw Error("it is no glow map");
            baked.glow = mipChain(std::move(glow));
        } else {
            baked.glow = mipChain(glowImage(scene_, material));
        }
        return baked;
    } catch (const Interrupted&) {
        throw;
    } catch (const std::exception& e) {
        spdlog::debug("cache entry {} is baked anew: {}", key, e.what());
        return std::nullopt;
    }
}

void BakeCache::store(const std::string& key, const Material& material, const BakedMaterial& baked)
{
    if (!folder_)
        return;
    try {
        nlohmann::json manifest = {{"key", key}};
        baker::writeExr(path(key, ".exr"), baked.reflectance);
        manifest["reflectance"] = fileHash(path(key, ".exr"));
        if (glowVaries(material)) {
            writeImage(path(key, "-glow.exr"), baked.glow.front());
            manifest["glow"] = fileHash(path(key, "-glow.exr"));
        }
        writeFileAtomically(path(key, ".json"), manifest.dump() + "\n");
    } catch (const Error& e) {
        spdlog::warn("{}; materials are baked anew each time", e.what());
        folder_.reset(); // said once
    }
}

} // namespace lumel::scene
