#include "texture_pool.h"
#include <algorithm>
#include <bit>

namespace lumel::tsl {

// A class's first block holds about this much, so that textures share it: each block takes a dispatch in
// every step of light and lower.
constexpr size_t kBlockBytes = size_t(12) << 20;
constexpr size_t kMaxLayers = 128;
// At most what a block of several textures takes: of the cap, since memory is given up by blocks, and of what
// is left.
constexpr size_t kShareOfCap = 12;
constexpr size_t kShareOfRoom = 8;

TextureLayout::TextureLayout(glm::uvec2 textureSize) : size(textureSize), extent(textureSize)
{
    mips = uint32_t(std::bit_width(std::max(size.x, size.y)));
    tiles = 0;
    for (uint32_t mip = 0; mip < mips; ++mip) {
        const glm::uvec2 lumels = glm::max(size >> mip, glm::uvec2(1));
        const glm::uvec2 count = (lumels + shared::kTileSize - 1u) / shared::kTileSize;
        tileOffsets[mip] = tiles;
        tiles += count.x * count.y;
        const glm::uvec2 origin = shared::mipOrigin(size, mip);
        extent = glm::max(extent, origin + lumels);
    }
}

size_t TextureLayout::layerBytes() const
{
    return size_t(extent.x) * extent.y * 8 + tiles * sizeof(shared::TileState);
}

TextureId TexturePool::latestOf(int object) const
{
    TextureId latest;
    const auto [first, last] = owned_.equal_range(object);
    for (auto i = first; i != last; ++i)
        if (!latest || texture(i->second).lastUsed > texture(latest).lastUsed)
            latest = i->second;
    return latest;
}

TextureId TexturePool::findRecyclable(glm::uvec2 size, uint64_t frame, bool freeOnly) const
{
    TextureId best;
    for (size_t b = 0; b < blocks_.size(); ++b) {
        if (blocks_[b].size != size)
            continue;
        for (uint32_t layer = 0; layer < blocks_[b].textures.size(); ++layer) {
            const PoolTexture& t = blocks_[b].textures[layer];
            if (t.owner < 0)
                return {int(b), layer};
            if (!freeOnly && t.lastUsed != frame && (!best || t.lastUsed < texture(best).lastUsed))
                best = {int(b), layer};
        }
    }
    return best;
}

// Gives up blocks that this frame does not use, least recently used first, until `bytes` fit below the limit.
bool TexturePool::evictFor(size_t bytes, size_t limit, uint64_t frame)
{
    while (usedBytes_ + bytes > limit) {
        int oldest = -1;
        uint64_t oldestUse = frame;
        for (size_t b = 0; b < blocks_.size(); ++b) {
            if (blocks_[b].textures.empty())
                continue;
            uint64_t use = 0;
            for (const PoolTexture& t : blocks_[b].textures)
                use = std::max(use, t.owner < 0 ? 0 : t.lastUsed);
            if (use < oldestUse) {
                oldest = int(b);
                oldestUse = use;
            }
        }
        if (oldest < 0)
            return false;
        PoolBlock& block = blocks_[size_t(oldest)];
        for (uint32_t layer = 0; layer < block.textures.size(); ++layer)
            disown({oldest, layer});
        usedBytes_ -= block.bytes();
        block = {};
    }
    return true;
}

// As many as the class has, while there is room.
uint32_t TexturePool::layersOfNext(const TextureLayout& layout, size_t limit) const
{
    size_t count = 0;
    for (const PoolBlock& block : blocks_)
        count += block.size == layout.size ? block.textures.size() : 0;
    const size_t room = limit - std::min(usedBytes_, limit);
    const size_t most = std::min(capBytes_ / kShareOfCap, room / kShareOfRoom) / layout.layerBytes();
    const size_t wanted = std::max(count, kBlockBytes / layout.layerBytes());
    return uint32_t(std::max<size_t>(1, std::min({wanted, most, kMaxLayers})));
}

void TexturePool::addBlock(glm::uvec2 size, size_t limit)
{
    const uint32_t layers = layersOfNext(TextureLayout(size), limit);
    auto slot =
        std::find_if(blocks_.begin(), blocks_.end(), [](const auto& b) { return b.textures.empty(); });
    if (slot == blocks_.end())
        slot = blocks_.emplace(blocks_.end());
    *slot = {.size = size, .textures = std::vector<PoolTexture>(layers)};
    usedBytes_ += slot->bytes();
}

void TexturePool::disown(TextureId id)
{
    const auto [first, last] = owned_.equal_range(at(id).owner);
    const auto entry = std::find_if(first, last, [&](const auto& e) { return e.second == id; });
    if (entry != last)
        owned_.erase(entry);
    at(id) = {};
}

TextureId TexturePool::claim(TextureId id, int object, uint32_t litLevel, uint64_t frame)
{
    disown(id);
    at(id) = {.owner = object, .litLevel = litLevel, .lastUsed = frame};
    owned_.emplace(object, id);
    return id;
}

TextureId TexturePool::acquire(int object, uint32_t litLevel, glm::uvec2 size, uint64_t frame)
{
    const auto [first, last] = owned_.equal_range(object);
    for (auto i = first; i != last; ++i)
        if (texture(i->second).litLevel == litLevel && blocks_[size_t(i->second.block)].size == size) {
            touch(i->second, frame);
            return i->second;
        }
    if (const TextureId unused = findRecyclable(size, frame, true))
        return claim(unused, object, litLevel, frame);
    // New memory before taking over: an object out of view for a moment then keeps its lumels.
    const size_t bytes = TextureLayout(size).layerBytes();
    const size_t limit = capBytes_ - leftFree_;
    if (usedBytes_ + bytes > limit)
        if (const TextureId old = findRecyclable(size, frame, false))
            return claim(old, object, litLevel, frame);
    if (!evictFor(bytes, limit, frame) && !evictFor(bytes, capBytes_, frame))
        return {};
    addBlock(size, limit);
    return claim(findRecyclable(size, frame, true), object, litLevel, frame);
}

} // namespace lumel::tsl
