// Baked materials on disk, by content.
//
// An entry is <key>.exr (the reflectance), <key>-glow.exr where glow varies, and <key>.json with the hash
// of each of these files' bytes, written last. An entry counts only if all hashes agree and the files
// can be read; so whatever is truncated, damaged, exchanged or of another version is baked anew.
#pragma once
#include "core/file.h"
#include "materials.h"
#include <optional>

namespace lumel::scene {

class BakeCache {
public:
    // Without a usable cache folder: one warning, and an always empty cache.
    BakeCache(const Scene& scene, const MaterialOptions& options);

    bool usable() const { return folder_.has_value(); }

    // Hash over the encoded images, factors, options and versions: nothing has to be decoded to know it.
    std::string key(const Material& material) const;

    std::optional<BakedMaterial> load(const std::string& key, const Material& material) const;
    void store(const std::string& key, const Material& material, const BakedMaterial& baked);

private:
    std::filesystem::path path(const std::string& key, const char* ending) const;

    const Scene& scene_;
    MaterialOptions options_;
    std::vector<std::string> imageHashes_;
    std::optional<std::filesystem::path> folder_;
};

} // namespace lumel::scene
