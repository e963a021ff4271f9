#include "bake_cache.h"
#include "material_fields.h"
#include "material_maps.h"
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

namespace lumel::scene {
namespace {

constexpr const char* kMapsVersion = "3"; // raise when material_maps.cpp changes its results

std::string fileHash(const std::filesystem::path& file)
{
    const auto bytes = readFile(file);
    return ContentHash().add(bytes.data(), bytes.size()).addValue(bytes.size()).hex();
}

nlohmann::json readJson(const std::filesystem::path& file)
{
    const auto text = readFile(file, 4096);
    const char* begin = reinterpret_cast<const char*>(text.data());
    return nlohmann::json::parse(begin, begin + text.size());
}

bool isUsable(const Image& emissive)
{
    if (emissive.empty() || emissive.channels != 4)
        return false;
    return std::all_of(emissive.pixels.begin(), emissive.pixels.end(),
                       [](float value) { return std::isfinite(value); });
}

// Tells a file that names a key from one that was damaged so that it names another.
std::string seal(const std::string& inputKey, const std::string& key)
{
    return ContentHash().add(inputKey).add(key).hex();
}

template<class Field>
void addField(ContentHash& hash, const Field& field)
{
    if constexpr (std::is_same_v<Field, std::string>)
        hash.add(field);
    else if constexpr (std::is_same_v<Field, std::filesystem::path>)
        hash.add(field.string());
    else if constexpr (std::is_same_v<Field, UvMapping>)
        forEachUvMappingField(field, [&](const auto& part) { hash.addValue(part); });
    else
        hash.addValue(field);
}

} // namespace

BakeCache::BakeCache(const Scene& scene, const MaterialOptions& options) : options_(options)
{
    for (const SceneImage& image : scene.images)
        imageHashes_.push_back(
            ContentHash().add(image.bytes.data(), image.bytes.size()).addValue(image.bytes.size()).hex());
    if (!options.useCache)
        return;
    try {
        folder_ = cacheFolder();
    } catch (const Error& e) {
        giveUp(e);
    }
}

void BakeCache::giveUp(const Error& reason)
{
    spdlog::warn("{}; materials are baked again on each run", reason.what());
    folder_.reset();
}

std::string BakeCache::inputKey(const Material& material) const
{
    Material m = material;
    // Neither reflectance nor emission depends on these.
    m.name.clear();
    m.bakedFile.clear();
    m.alphaMode = AlphaMode::opaque;
    m.alphaCutoff = 0.0f;
    m.doubleSided = false;
    ContentHash hash;
    hash.add(std::string(baker::kVersion)).add(std::string(kMapsVersion));
    hash.addValue(options_.method).addValue(options_.model);
    const auto add = [&](const auto& field) {
        // Integers are indices of images: their contents count, not where they stand in the file.
        if constexpr (std::is_same_v<decltype(field), const int&>)
            hash.add(field < 0 ? std::string("none") : imageHashes_.at(size_t(field)));
        else
            addField(hash, field);
    };
    forEachMaterialField(std::as_const(m), add);
    return hash.hex();
}

std::string BakeCache::key(const baker::Maps& maps, const Image& emissive) const
{
    ContentHash hash;
    hash.add(baker::sourceHash(maps, {options_.method, options_.model}));
    hash.addValue(emissive.width).addValue(emissive.height).addValue(emissive.channels);
    hash.add(emissive.pixels.data(), emissive.pixels.size() * sizeof(float));
    return hash.hex();
}

std::filesystem::path BakeCache::path(const std::string& key, const char* ending) const
{
    return *folder_ / (key + ending);
}

std::optional<std::string> BakeCache::recall(const std::string& inputKey) const
{
    if (const auto found = keys_.find(inputKey); found != keys_.end())
        return found->second;
    if (!folder_ || !std::filesystem::exists(path(inputKey, "-key.json")))
        return std::nullopt;
    try {
        const auto entry = readJson(path(inputKey, "-key.json"));
        const std::string key = entry.at("key");
        if (entry.at("seal") != seal(inputKey, key))
            throw Error("the file has changed since it was stored");
        return key;
    } catch (const std::exception& e) {
        spdlog::debug("cache entry {} is made anew: {}", inputKey, e.what());
        return std::nullopt;
    }
}

void BakeCache::remember(const std::string& inputKey, const std::string& key)
{
    keys_[inputKey] = key;
    if (!folder_)
        return;
    try {
        const nlohmann::json entry = {{"key", key}, {"seal", seal(inputKey, key)}};
        writeFileAtomically(path(inputKey, "-key.json"), entry.dump() + "\n");
    } catch (const Error& e) {
        giveUp(e);
    }
}

std::optional<BakedMaterial> BakeCache::load(const std::string& key) const
{
    if (!folder_ || !std::filesystem::exists(path(key, ".json")))
        return std::nullopt;
    try {
        const auto manifest = readJson(path(key, ".json"));
        if (manifest.at("key") != key || manifest.at("reflectance") != fileHash(path(key, ".exr")))
            throw Error("the file has changed since it was stored");
        BakedMaterial baked;
        baked.reflectance = baker::readExr(path(key, ".exr"));
        if (baked.reflectance.version != baker::kVersion)
            throw Error("written by another version");
        Image emissive(1, 1, 4);
        if (manifest.at("emissive").is_array())
            emissive.pixels = manifest["emissive"].get<std::vector<float>>();
        else if (manifest["emissive"] == fileHash(path(key, "-emissive.exr")))
            emissive = readImage(path(key, "-emissive.exr"));
        else
            throw Error("the file has changed since it was stored");
        if (emissive.pixels.size() != 4 * size_t(emissive.width) * size_t(emissive.height) ||
            !isUsable(emissive))
            throw Error("not an emissive map");
        baked.emissive = mipChain(std::move(emissive));
        return baked;
    } catch (const Interrupted&) {
        throw;
    } catch (const std::exception& e) {
        spdlog::debug("cache entry {} is baked anew: {}", key, e.what());
        return std::nullopt;
    }
}

void BakeCache::store(const std::string& key, const BakedMaterial& baked)
{
    if (!folder_)
        return;
    try {
        nlohmann::json manifest = {{"key", key}};
        baker::writeExr(path(key, ".exr"), baked.reflectance);
        manifest["reflectance"] = fileHash(path(key, ".exr"));
        const Image& emissive = baked.emissive.front();
        if (emissive.width * emissive.height == 1) {
            manifest["emissive"] = emissive.pixels;
        } else {
            writeImage(path(key, "-emissive.exr"), emissive);
            manifest["emissive"] = fileHash(path(key, "-emissive.exr"));
        }
        writeFileAtomically(path(key, ".json"), manifest.dump() + "\n");
    } catch (const Error& e) {
        giveUp(e);
    }
}

} // namespace lumel::scene
