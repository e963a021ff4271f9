// Recycled lit textures: who draws which texture. CPU bookkeeping only; passes/lit_pool.h owns the images.
// Objects own nothing. Textures of one size class (powers of two) are layers of blocks, so that one dispatch
// serves many objects: each new block of a class doubles what it has, while there is room. Within a
// class the least recently used texture is taken over first, and the bytes of all blocks never pass the cap.
#pragma once
#include "shared/structs.h"
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

namespace lumel::tsl {

// How a lit texture of a size lies in its layer, and what it costs.
struct TextureLayout {
    explicit TextureLayout(glm::uvec2 size); // powers of two
    glm::uvec2 size;
    uint32_t mips;
    glm::uvec2 extent; // lumels of a layer: MIP 0 and the others beside it
    std::array<uint32_t, shared::kMaxLevels> tileOffsets{}; // first tile of each MIP
    uint32_t tiles;                                         // of all MIPs
    size_t layerBytes() const;                              // RGBA16F and the tiles' states
};

struct TextureId {
    int block = -1;
    uint32_t layer = 0;
    explicit operator bool() const { return block >= 0; }
    bool operator==(const TextureId&) const = default;
};

struct PoolTexture {
    int owner = -1;        // object, -1 = free
    uint32_t litLevel = 0; // the owner's level of MIP 0
    uint64_t lastUsed = 0; // frame
};

struct PoolBlock {
    glm::uvec2 size{0};                // zero: given up, the slot is free
    std::vector<PoolTexture> textures; // a layer each
    size_t bytes() const { return TextureLayout(size).layerBytes() * textures.size(); }
};

class TexturePool {
public:
    explicit TexturePool(size_t capBytes) : capBytes_(capBytes) {}

    // A texture of `size` for the object's level in this frame: its own when it has one, else a free one,
    // else one of a new block within the cap, else the least recently used of an earlier frame (of the same
    // class, or of a block of others, whose memory is then given up). Nothing when all that is left is in
    // use.
    TextureId acquire(int object, uint32_t litLevel, glm::uvec2 size, uint64_t frame);

    const std::vector<PoolBlock>& blocks() const { return blocks_; }
    const PoolTexture& texture(TextureId id) const { return blocks_[size_t(id.block)].textures[id.layer]; }
    // The object's most recently used texture.
    TextureId latestOf(int object) const;
    // What is left below the cap as long as textures that no frame draws can make room instead.
    void leaveFree(size_t bytes) { leftFree_ = bytes < capBytes_ ? bytes : capBytes_; }
    // Uses a texture in a frame that needed nothing new of it.
    void touch(TextureId id, uint64_t frame) { at(id).lastUsed = frame; }

    size_t usedBytes() const { return usedBytes_; }
    size_t capBytes() const { return capBytes_; }
    size_t textureCount() const { return owned_.size(); } // with an owner

private:
    PoolTexture& at(TextureId id) { return blocks_[size_t(id.block)].textures[id.layer]; }
    TextureId claim(TextureId id, int object, uint32_t litLevel, uint64_t frame);
    TextureId findRecyclable(glm::uvec2 size, uint64_t frame, bool freeOnly) const;
    bool evictFor(size_t bytes, size_t limit, uint64_t frame);
    uint32_t layersOfNext(const TextureLayout& layout, size_t limit) const;
    void addBlock(glm::uvec2 size, size_t limit);
    void disown(TextureId id);

    size_t capBytes_;
    size_t leftFree_ = 0;
    size_t usedBytes_ = 0;
    std::vector<PoolBlock> blocks_;
    std::multimap<int, TextureId> owned_; // by object
};

} // namespace lumel::tsl
