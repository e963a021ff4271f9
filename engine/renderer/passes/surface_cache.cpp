#include "surface_cache.h"
#include <algorithm>

namespace lumel {

SurfaceCache::SurfaceCache(const gpu::Device& device)
    : device_(device), layout_(gpu::makeSetLayout(device, {vk::DescriptorType::eUniformTexelBuffer})),
      set_(gpu::makeSet(device, layout_))
{
}

void SurfaceCache::allocate(gpu::FrameRing& ring, uint32_t capacity)
{
    ring.waitForAll();
    view_ = nullptr;
    words_ = {}; // free first, so that memory never passes the cap
    state_.capacity = capacity;
    state_.emptied = 1;
    if (capacity == 0)
        return;
    words_ = gpu::Buffer(device_, capacity * kTileBytes, gpu::Buffer::MemoryUsage::device, "surface cache",
                         "use a smaller --pool-mb", gpu::MemoryKind::surfaceCache);
    view_ = gpu::makeTexelView(device_, words_);
    gpu::writeTexels(device_, *set_, 0, *view_);
}

size_t SurfaceCache::roomFor(size_t tiles)
{
    // In steps, so that a few tiles more or less change nothing.
    constexpr size_t kStep = size_t(16) << 20;
    const size_t bytes = (tiles + tiles / 2) * kTileBytes;
    return (bytes + kStep - 1) / kStep * kStep;
}

void SurfaceCache::reserve(gpu::FrameRing& ring, size_t tiles, size_t capBytes)
{
    // Below this many it is not worth its passes.
    constexpr size_t kLeastTiles = 64;
    const size_t words = kTileBytes / sizeof(glm::uvec4);
    const size_t most =
        std::min(capBytes / kTileBytes, size_t(device_.limits().core.maxTexelBufferElements) / words);
    // Frames leave an eighth of the ring to what they add; views move on.
    const size_t needed = std::min(tiles + tiles / 4, most), wanted = std::min(2 * tiles, most);
    const size_t fewest = std::min(roomFor(tiles) / kTileBytes, most);
    if (state_.capacity > most) // textures grow: not past roomFor() if they can help it
        allocate(ring, uint32_t(fewest >= kLeastTiles ? fewest : 0));
    else if (needed > state_.capacity + state_.capacity / 8 && wanted >= kLeastTiles)
        allocate(ring, uint32_t(wanted));
}

} // namespace lumel
