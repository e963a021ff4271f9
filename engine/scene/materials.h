// A scene's materials, baked by the embedded baker or taken from the cache.
#pragma once
#include "half_maps.h"
#include "scene.h"
#include <deque>
#include <map>
#include <set>

namespace lumel::scene {

struct BakedMaterial {
    Reflectance reflectance;
    // What the material adds and takes away besides reflecting: rgb = emitted radiance (linear), alpha =
    // ambient occlusion (1 open). Of a size of its own; 1 x 1 when constant.
    HalfChain emissive;
    // One channel, the share of light that the surface stops: base colour alpha of masked and blended
    // materials, mipped; 1 x 1 where it does not vary.
    HalfChain opacity;
};

// Which choices were given, not left at their defaults: a model's own chains must agree with them.
struct AskedBake {
    bool method = false, model = false, lobes = false;
};

struct MaterialOptions {
    baker::Method method = baker::Method::fit;
    baker::Model model = baker::Model::ashikhminShirley;
    baker::LobeCount lobes = baker::LobeCount::automatic; // of the method fit
    bool useCache = true;
    int threads = 0;    // 0 = all cores
    bool quick = false; // what is not in the cache is not baked: its placeholder stays, which is said
    AskedBake asked{};
};

class BakeCache;

// Materials that are equal, with what was baked for them.
struct FinishedBake {
    std::vector<size_t> materials;
    Reflectance reflectance;
};

// Bakes a scene's materials one after the other, so that something can be shown before all are done. Throws
// as bakeMaterials().
class MaterialBaker {
public:
    MaterialBaker(const Scene& scene, const MaterialOptions& options);
    ~MaterialBaker();
    MaterialBaker(const MaterialBaker&) = delete;
    MaterialBaker& operator=(const MaterialBaker&) = delete;

    // All of them: from the cache, or with a placeholder of the same sizes in place of the reflectance.
    std::vector<BakedMaterial> placeholders();
    std::set<size_t> pending() const; // materials that have a placeholder
    // Bakes the next of them; nothing once there is none. Finished bakes are in the cache.
    std::optional<FinishedBake> next();
    // In place of these three.
    std::vector<BakedMaterial> all();

private:
    struct Pending {
        std::vector<size_t> materials; // equal ones; the first counts
        std::string inputKey, key;
        std::optional<baker::Maps> maps; // nothing: to be decoded again
    };
    // Adds the next material to done_: as it is stored, or with emission alone and a bake pending.
    void add(size_t material);
    bool take(const std::string& key, size_t material);
    void addPlaceholder();
    void addOpacity();
    FinishedBake finish(Pending pending, const std::string& label);
    std::string nameOf(size_t material) const;
    baker::Options bakeOptions() const;

    const Scene& scene_;
    MaterialOptions options_;
    std::unique_ptr<BakeCache> cache_;
    std::vector<std::filesystem::path> chains_; // of each material; empty where its maps are baked
    std::vector<BakedMaterial> done_;
    std::map<std::string, size_t> first_; // material of a key
    std::deque<Pending> pending_;
    size_t begun_ = 0, planned_ = 0; // bakes
    size_t texels_ = 0, keptBytes_ = 0;
};

// One for each of scene.materials, with a progress line for each that is not in the cache. Throws Error
// for images that cannot be decoded and Interrupted after Ctrl-C; trouble with the cache is a warning.
std::vector<BakedMaterial> bakeMaterials(const Scene& scene, const MaterialOptions& options);

} // namespace lumel::scene
