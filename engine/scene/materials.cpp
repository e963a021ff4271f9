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

// Of all chains' finest levels; 64 bytes a texel with the coarser ones: 16 GiB.
constexpr size_t kMaxSceneTexels = size_t(1) << 28;

BakedMaterial bakeOne(const Scene& scene, const Material& material, const MaterialOptions& options,
                      const std::string& label)
{
    const baker::Maps maps = reflectanceMaps(scene, material);
    Progress progress(label, baker::progressUnits(maps));
    BakedMaterial baked;
    try {
        baked.reflectance = baker::bake(maps, {options.method, options.model, options.threads}, &progress);
    } catch (const Error& e) { // the baker knows maps, not files
        throw Error(fmt::format("{}: material '{}': {}", scene.file.string(), material.name, e.what()));
    }
    baked.glow = mipChain(glowImage(scene, material));
    return baked;
}

} // namespace

std::vector<BakedMaterial> bakeMaterials(const Scene& scene, const MaterialOptions& options)
{
    BakeCache cache(scene, options);
    std::vector<BakedMaterial> all;
    all.reserve(scene.materials.size());
    std::map<std::string, size_t> done; // materials that differ in name only are baked once
    size_t bakedCount = 0;
    const auto start = std::chrono::steady_clock::now();
    size_t texels = 0;
    for (size_t i = 0; i < scene.materials.size(); ++i) {
        if (i > 0) {
            const baker::Level& finest = all.back().reflectance.levels.front();
            texels += size_t(finest.width) * size_t(finest.height);
        }
        if (texels > kMaxSceneTexels)
            throw Error(fmt::format("{}: its materials have more than {} texels; scale its images down",
                                    scene.file.string(), kMaxSceneTexels));
        const Material& material = scene.materials[i];
        if (!material.bakedFile.empty()) {
            all.push_back({.reflectance = baker::readExr(material.bakedFile),
                           .glow = mipChain(glowImage(scene, material)),
                           .opacity = {}});
            continue;
        }
        const std::string key = cache.key(material);
        if (const auto [twin, isNew] = done.try_emplace(key, i); !isNew) {
            all.push_back(all[twin->second]);
            continue;
        }
        if (auto found = cache.load(key, material)) {
            all.push_back(std::move(*found));
            continue;
        }
        const std::string label =
            fmt::format("baking {}/{} {}", i + 1, scene.materials.size(), material.name);
        all.push_back(bakeOne(scene, material, options, label));
        cache.store(key, material, all.back());
        // The file holds half floats. Going on with what it says makes the first run and all later ones
        // give the same picture.
        if (auto stored = cache.load(key, material))
            all.back() = std::move(*stored);
        else if (cache.usable())
            spdlog::warn("{}: material '{}' cannot be read back from the cache; it is baked anew each time",
                         scene.file.string(), material.name);
        ++bakedCount;
    }
    // Not cached: few materials have any, and twins may differ in it.
    for (size_t i = 0; i < all.size(); ++i)
        all[i].opacity = mipChain(opacityImage(scene, scene.materials[i]));
    if (bakedCount > 0) {
        const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
        spdlog::info("{}: {} of {} materials baked in {:.1f} s", scene.file.string(), bakedCount,
                     scene.materials.size(), seconds.count());
    }
    return all;
}

} // namespace lumel::scene
