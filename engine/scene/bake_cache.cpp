#include "bake_cache.h"
#include "material_fields.h"
#include "material_maps.h"
#include "own_chains.h"
#include <cstring>
#include <fmt/format.h>
#include <fstream>
#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>
#include <tbb/parallel_for.h>

namespace lumel::scene {
namespace {

constexpr const char* kMapsVersion = "3"; // raise when material_maps.cpp changes its results
constexpr const char* kEnding = ".maps";
constexpr size_t kChains = 7;                        // of an entry
constexpr int kMaxSide = 16384;                      // texels, of an image
constexpr uintmax_t kMaxBytes = uintmax_t(12) << 30; // the most that one scene may need, and a little more

nlohmann::json readJson(const std::filesystem::path& file)
{
    const auto text = readFile(file, 4096);
    const char* begin = reinterpret_cast<const char*>(text.data());
    return nlohmann::json::parse(begin, begin + text.size());
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

// An entry: this, then the chains' texels.
struct Header {
    // Another number when half_maps.cpp, baseReflectance() or emissiveChain() change their results.
    std::array<char, 16> format = {"lumel maps 2"};
    std::array<char, 32> key{}, contents{}; // hashes: of what was baked, and of sizes and texels
    std::array<glm::ivec2, kChains> sizes{};
};

std::array<const HalfChain*, kChains> chainsOf(const BakedMaterial& baked)
{
    const Reflectance& r = baked.reflectance;
    return {&r.normal, &r.specular, &r.diffuse, &r.base, &baked.emissive, &r.second, &r.secondSpecular};
}

std::array<char, 32> digits(const std::string& hash)
{
    std::array<char, 32> result{};
    std::ranges::copy(hash, result.begin());
    return result;
}

using Bytes = std::span<const std::byte>;

// Hashes parts of 1 MiB on all cores, then their hashes.
std::array<char, 32> hashOf(const std::array<glm::ivec2, kChains>& sizes, std::span<const Bytes> chains)
{
    constexpr size_t kPart = 1 << 20;
    ContentHash all;
    all.addValue(sizes);
    for (const Bytes& chain : chains) {
        std::vector<std::string> hashes((chain.size() + kPart - 1) / kPart);
        tbb::parallel_for(size_t(0), hashes.size(), [&](size_t i) {
            const Bytes part = chain.subspan(i * kPart, std::min(kPart, chain.size() - i * kPart));
            hashes[i] = ContentHash().add(part.data(), part.size()).hex();
        });
        for (const std::string& hash : hashes)
            all.add(hash);
    }
    return digits(all.hex());
}

BakedMaterial readEntry(const std::filesystem::path& path, const std::string& key)
{
    const auto damaged = [] { return Error("the file has changed since it was stored"); };
    const auto file = std::make_shared<const MappedFile>(path);
    Header header;
    Bytes rest = file->bytes();
    if (rest.size() < sizeof header)
        throw damaged();
    std::memcpy(&header, rest.data(), sizeof header);
    rest = rest.subspan(sizeof header);
    if (header.format != Header().format || header.key != digits(key))
        throw damaged();
    std::array<HalfChain, kChains> chains;
    std::array<Bytes, kChains> bytes;
    for (size_t i = 0; i < chains.size(); ++i) {
        const glm::ivec2 size = header.sizes[i];
        if (size == glm::ivec2(0) && i >= kChains - 2)
            continue; // no second lobes
        if (std::min(size.x, size.y) < 1 || std::max(size.x, size.y) > kMaxSide ||
            HalfChain::byteCount(size) > rest.size())
            throw damaged();
        chains[i] = HalfChain(size, reinterpret_cast<const uint16_t*>(rest.data()), file);
        bytes[i] = chains[i].bytes();
        rest = rest.subspan(bytes[i].size());
    }
    if (!rest.empty() || header.contents != hashOf(header.sizes, bytes))
        throw damaged();
    auto& [normal, specular, diffuse, base, emissive, second, secondSpecular] = chains;
    BakedMaterial baked;
    baked.reflectance.normal = normal;
    baked.reflectance.specular = specular;
    baked.reflectance.diffuse = diffuse;
    baked.reflectance.base = base;
    baked.reflectance.second = second;
    baked.reflectance.secondSpecular = secondSpecular;
    baked.emissive = emissive;
    return baked;
}

void writeEntry(const std::filesystem::path& path, const std::string& key, const BakedMaterial& baked)
{
    Header header;
    header.key = digits(key);
    std::array<Bytes, kChains> bytes;
    const auto chains = chainsOf(baked);
    for (size_t i = 0; i < chains.size(); ++i) {
        header.sizes[i] = chains[i]->size();
        bytes[i] = chains[i]->bytes();
    }
    header.contents = hashOf(header.sizes, bytes);
    writeAtomically(path, [&](const std::filesystem::path& temporary) {
        std::ofstream stream(temporary, std::ios::binary);
        stream.write(reinterpret_cast<const char*>(&header), sizeof header);
        for (const Bytes& chain : bytes)
            stream.write(reinterpret_cast<const char*>(chain.data()), std::streamsize(chain.size()));
        stream.close();
        if (!stream)
            throw Error(fmt::format("{}: cannot be written ({})", path.string(), std::strerror(errno)));
    });
}

} // namespace

BakeCache::BakeCache(const Scene& scene, const MaterialOptions& options) : options_(options)
{
    for (const SceneImage& image : scene.images)
        imageHashes_.push_back(imageHash(image.bytes));
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
    m.ownChain.clear();
    m.ownMaps.clear();
    m.alphaMode = AlphaMode::opaque;
    m.alphaCutoff = 0.0f;
    m.doubleSided = false;
    ContentHash hash;
    hash.add(std::string(baker::kVersion)).add(std::string(baker::kResults)).add(std::string(kMapsVersion));
    hash.addValue(options_.method).addValue(options_.model).addValue(options_.lobes);
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
    hash.add(baker::sourceHash(
        maps, {.method = options_.method, .model = options_.model, .lobes = options_.lobes}));
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
        spdlog::debug("cache entry {} is recreated: {}", inputKey, e.what());
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
    if (!folder_ || !std::filesystem::exists(path(key, kEnding)))
        return std::nullopt;
    try {
        BakedMaterial baked = readEntry(path(key, kEnding), key);
        markUsed(path(key, kEnding));
        return baked;
    } catch (const Error& e) {
        spdlog::debug("cache entry {} is baked again: {}", key, e.what());
        return std::nullopt;
    }
}

void BakeCache::store(const std::string& key, const BakedMaterial& baked)
{
    if (!folder_)
        return;
    try {
        writeEntry(path(key, kEnding), key, baked);
        deleteUnused(*folder_, kMaxBytes);
    } catch (const Error& e) {
        giveUp(e);
    }
}

} // namespace lumel::scene
