// Baked materials on disk, by content.
//
// An entry is <key>.maps: sizes, a hash of all that follows, and the half floats that the GPU reads, which
// are mapped, not copied. An entry counts only if its key and its hash agree; so whatever is truncated,
// damaged or exchanged is baked again. The entries that were used least recently make room for new ones.
//
// The key is a hash of what is baked: the decoded, joined maps and the options. Since decoding takes longer
// than all else in a start with a full cache, <inputs>-key.json keeps the key that a material led to, under
// a hash of its fields and encoded images. That hash may change where the key does not (the images are then
// decoded to find that out), never the other way round.
#pragma once
#include "core/error.h"
#include "core/file.h"
#include "materials.h"
#include <map>
#include <optional>

namespace lumel::scene {

class BakeCache {
public:
    // Without a usable cache folder: one warning, and an always empty cache.
    BakeCache(const Scene& scene, const MaterialOptions& options);

    const std::vector<std::string>& imageHashes() const { return imageHashes_; } // of the scene's images
    // Of all fields that maps can depend on, the encoded images, options and versions: nothing is decoded.
    std::string inputKey(const Material& material) const;
    // Of what is baked.
    std::string key(const baker::Maps& maps, const Image& emissive) const;

    // The key that these inputs led to, in this run or an earlier one.
    std::optional<std::string> recall(const std::string& inputKey) const;
    void remember(const std::string& inputKey, const std::string& key);

    std::optional<BakedMaterial> load(const std::string& key) const;
    void store(const std::string& key, const BakedMaterial& baked);

private:
    std::filesystem::path path(const std::string& key, const char* ending) const;
    void giveUp(const Error& reason); // said once

    MaterialOptions options_;
    std::vector<std::string> imageHashes_;
    std::optional<std::filesystem::path> folder_;
    std::map<std::string, std::string> keys_; // by input key, of this run
};

} // namespace lumel::scene
