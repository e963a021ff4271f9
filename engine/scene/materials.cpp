#include "materials.h"
#include "bake_cache.h"
#include "core/error.h"
#include "material_maps.h"
#include <chrono>
#include <fmt/format.h>
#include <map>
#include <spdlog/spdlog.h>

namespace lumel::scene {
namespace {

// Of all chains' finest levels; 32 bytes a texel on the GPU, 43 with the coarser ones: 11 GiB.
constexpr size_t kMaxSceneTexels = size_t(1) << 28;

// What a material is baked from.
struct Decoded {
    baker::Maps maps;
    Image emissive;
};

BakedMaterial bakeOne(const Scene& scene, const Material& material, Decoded decoded,
                      const MaterialOptions& options, const std::string& label)
{
    Progress progress(label, baker::progressUnits(decoded.maps));
    BakedMaterial baked;
    try {
        baked.reflectance = baker::bake(decoded.maps,
                                        {.method = options.method,
                                         .model = options.model,
                                         .threads = options.threads,
                                         .lobes = options.lobes},
                                        &progress);
    } catch (const Error& e) { // the baker knows maps, not files
        throw Error(fmt::format("{}: material '{}': {}", scene.file.string(), material.name, e.what()));
    }
    baked.emissive = emissiveChain(std::move(decoded.emissive));
    return baked;
}

// The materials of a scene, one after the other.
class MaterialBaker {
public:
    MaterialBaker(const Scene& scene, const MaterialOptions& options)
        : scene_(scene), options_(options), cache_(scene, options)
    {
    }

    void add(size_t index);

    std::vector<BakedMaterial> all;
    size_t bakedCount = 0;

private:
    // As an equal material of this scene or from the cache; then it is the last of `all`.
    bool take(const std::string& key);

    const Scene& scene_;
    const MaterialOptions& options_;
    BakeCache cache_;
    std::map<std::string, size_t> done_; // index of the first material of a key
};

bool MaterialBaker::take(const std::string& key)
{
    const auto [twin, isNew] = done_.try_emplace(key, all.size());
    if (!isNew) {
        all.push_back(all[twin->second]);
        return true;
    }
    auto found = cache_.load(key);
    if (found)
        all.push_back(std::move(*found));
    else
        done_.erase(twin);
    return found.has_value();
}

void MaterialBaker::add(size_t index)
{
    const Material& material = scene_.materials[index];
    if (!material.bakedFile.empty()) {
        all.push_back({.reflectance = baker::readExr(material.bakedFile),
                       .emissive = emissiveChain(emissiveImage(scene_, material)),
                       .opacity = {}});
        return;
    }
    const std::string inputKey = cache_.inputKey(material);
    if (const auto known = cache_.recall(inputKey); known && take(*known))
        return;
    Decoded decoded{reflectanceMaps(scene_, material), emissiveImage(scene_, material)};
    const std::string key = cache_.key(decoded.maps, decoded.emissive);
    if (take(key)) {
        cache_.remember(inputKey, key);
        return;
    }
    done_[key] = all.size();
    all.push_back(bakeOne(scene_, material, std::move(decoded), options_,
                          fmt::format("baking {}/{} {}", index + 1, scene_.materials.size(), material.name)));
    cache_.store(key, all.back());
    cache_.remember(inputKey, key);
    ++bakedCount;
}

} // namespace

std::vector<BakedMaterial> bakeMaterials(const Scene& scene, const MaterialOptions& options)
{
    MaterialBaker work(scene, options);
    std::vector<BakedMaterial>& all = work.all;
    all.reserve(scene.materials.size());
    const auto start = std::chrono::steady_clock::now();
    size_t texels = 0;
    for (size_t i = 0; i < scene.materials.size(); ++i) {
        work.add(i);
        const glm::ivec2 size = all.back().reflectance.size();
        texels += size_t(size.x) * size_t(size.y);
        if (texels > kMaxSceneTexels)
            throw Error(fmt::format("{}: its materials have more than {} texels; scale its images down",
                                    scene.file.string(), kMaxSceneTexels));
    }
    // Not cached: few materials have any, and twins may differ in it.
    for (size_t i = 0; i < all.size(); ++i)
        all[i].opacity = HalfChain(mipChain(opacityImage(scene, scene.materials[i])));
    if (work.bakedCount > 0) {
        const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
        spdlog::info("{}: {} of {} materials baked in {:.1f} s", scene.file.string(), work.bakedCount,
                     scene.materials.size(), seconds.count());
    }
    return std::move(work.all);
}

} // namespace lumel::scene
