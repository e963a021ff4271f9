#include "materials.h"
#include "bake_cache.h"
#include "core/error.h"
#include "material_maps.h"
#include "own_chains.h"
#include <algorithm>
#include <chrono>
#include <fmt/format.h>
#include <future>
#include <spdlog/spdlog.h>

namespace lumel::scene {
namespace {

// Of all chains' finest levels; 32 bytes a texel on the GPU, 43 with the coarser ones: 11 GiB.
constexpr size_t kMaxSceneTexels = size_t(1) << 28;
// Of decoded maps that wait for their bake; what exceeds it is decoded a second time.
constexpr size_t kMostKeptBytes = size_t(512) << 20;

size_t bytesOf(const baker::Maps& maps)
{
    size_t floats = 0;
    for (const Image* map : {&maps.height, &maps.normal, &maps.power, &maps.roughness, &maps.anisotropy,
                             &maps.tangentRotation, &maps.specular, &maps.diffuse})
        floats += map->pixels.size();
    return floats * sizeof(float);
}

} // namespace

MaterialBaker::MaterialBaker(const Scene& scene, const MaterialOptions& options)
    : scene_(scene), options_(options), cache_(std::make_unique<BakeCache>(scene, options)),
      chains_(chainsToRead(scene, options, cache_->imageHashes()))
{
    done_.reserve(scene.materials.size());
}

MaterialBaker::~MaterialBaker() = default;

baker::Options MaterialBaker::bakeOptions() const
{
    return {.method = options_.method,
            .model = options_.model,
            .threads = options_.threads,
            .lobes = options_.lobes};
}

// For messages.
std::string MaterialBaker::nameOf(size_t material) const
{
    return fmt::format("{}: material '{}'", scene_.file.string(), scene_.materials[material].name);
}

// As an equal material of this scene or from the cache.
bool MaterialBaker::take(const std::string& key, size_t material)
{
    if (const auto twin = first_.find(key); twin != first_.end()) {
        done_.push_back(done_[twin->second]);
        for (Pending& pending : pending_)
            if (pending.key == key)
                pending.materials.push_back(material);
        return true;
    }
    auto found = cache_->load(key);
    if (!found)
        return false;
    first_[key] = material;
    done_.push_back(std::move(*found));
    return true;
}

void MaterialBaker::add(size_t index)
{
    const Material& material = scene_.materials[index];
    if (!chains_[index].empty()) {
        done_.push_back({.reflectance = baker::readExr(chains_[index]),
                         .emissive = emissiveChain(emissiveImage(scene_, material)),
                         .opacity = {}});
        return;
    }
    const std::string inputKey = cache_->inputKey(material);
    if (const auto known = cache_->recall(inputKey); known && take(*known, index))
        return;
    // Images take long to decode: those of emission beside the others.
    auto emission = std::async(std::launch::async, [&, monitor = monitorOfThisThread()] {
        monitorThisThread(monitor);
        return emissiveImage(scene_, material);
    });
    baker::Maps maps = reflectanceMaps(scene_, material);
    Image emissive = emission.get();
    checkInterrupted();
    const std::string key = cache_->key(maps, emissive);
    if (take(key, index)) {
        if (std::ranges::none_of(pending_, [&](const Pending& pending) { return pending.key == key; }))
            cache_->remember(inputKey, key);
        return;
    }
    checkInterrupted();
    first_[key] = index;
    done_.push_back({.reflectance = {}, .emissive = emissiveChain(std::move(emissive)), .opacity = {}});
    pending_.push_back({.materials = {index}, .inputKey = inputKey, .key = key, .maps = std::move(maps)});
}

// Of the last material, which is pending.
void MaterialBaker::addPlaceholder()
{
    std::optional<baker::Maps>& maps = pending_.back().maps;
    try {
        done_.back().reflectance = baker::placeholder(*maps, bakeOptions());
    } catch (const Error& e) { // the baker knows maps, not files
        throw Error(fmt::format("{}: {}", nameOf(done_.size() - 1), e.what()));
    }
    keptBytes_ += bytesOf(*maps);
    if (keptBytes_ > kMostKeptBytes) {
        keptBytes_ -= bytesOf(*maps);
        maps.reset();
    }
}

// Of the last material. Not cached: few have any, and twins may differ in it.
void MaterialBaker::addOpacity()
{
    done_.back().opacity = HalfChain(mipChain(opacityImage(scene_, scene_.materials[done_.size() - 1])));
    const glm::ivec2 size = done_.back().reflectance.size();
    texels_ += size_t(size.x) * size_t(size.y);
    if (texels_ > kMaxSceneTexels)
        throw Error(fmt::format("{}: its materials have more than {} texels; scale its images down",
                                scene_.file.string(), kMaxSceneTexels));
}

FinishedBake MaterialBaker::finish(Pending pending, const std::string& label)
{
    const size_t first = pending.materials.front();
    const baker::Maps maps =
        pending.maps ? std::move(*pending.maps) : reflectanceMaps(scene_, scene_.materials[first]);
    Progress progress(label, baker::progressUnits(maps));
    try {
        done_[first].reflectance = baker::bake(maps, bakeOptions(), &progress);
    } catch (const Error& e) {
        throw Error(fmt::format("{}: {}", nameOf(first), e.what()));
    }
    cache_->store(pending.key, done_[first]);
    cache_->remember(pending.inputKey, pending.key);
    return {std::move(pending.materials), done_[first].reflectance};
}

std::vector<BakedMaterial> MaterialBaker::placeholders()
{
    for (size_t i = 0; i < scene_.materials.size(); ++i) {
        add(i);
        if (!pending_.empty() && pending_.back().materials.front() == i)
            addPlaceholder();
        addOpacity();
        checkInterrupted();
    }
    planned_ = pending_.size();
    return done_;
}

std::set<size_t> MaterialBaker::pending() const
{
    std::set<size_t> materials;
    for (const Pending& pending : pending_)
        materials.insert(pending.materials.begin(), pending.materials.end());
    return materials;
}

std::optional<FinishedBake> MaterialBaker::next()
{
    if (pending_.empty())
        return std::nullopt;
    Pending pending = std::move(pending_.front());
    pending_.pop_front();
    ++begun_;
    const std::string& name = scene_.materials[pending.materials.front()].name;
    return finish(std::move(pending), fmt::format("baking material {} of {}: {}", begun_, planned_, name));
}

std::vector<BakedMaterial> MaterialBaker::all()
{
    const auto start = std::chrono::steady_clock::now();
    size_t baked = 0;
    const size_t count = scene_.materials.size();
    for (size_t i = 0; i < count; ++i) {
        add(i);
        if (!pending_.empty()) {
            finish(std::move(pending_.front()),
                   fmt::format("baking {}/{} {}", i + 1, count, scene_.materials[i].name));
            pending_.clear();
            ++baked;
        }
        addOpacity();
    }
    if (baked > 0) {
        const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
        spdlog::info("{}: {} of {} materials baked in {:.1f} s", scene_.file.string(), baked, count,
                     seconds.count());
    }
    return std::move(done_);
}

std::vector<BakedMaterial> bakeMaterials(const Scene& scene, const MaterialOptions& options)
{
    MaterialBaker work(scene, options);
    if (!options.quick)
        return work.all();
    std::vector<BakedMaterial> all = work.placeholders();
    if (const size_t count = work.pending().size(); count > 0)
        spdlog::warn("{}: {} of {} materials are not baked: --quick shows closed forms of them",
                     scene.file.string(), count, scene.materials.size());
    return all;
}

} // namespace lumel::scene
