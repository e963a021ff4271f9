#include "surface_cache.h"
#include <algorithm>

namespace lumel {
namespace {

// Behind the ring's end, for the last pages of a tile that begins before it.
constexpr size_t kPagesBehind = shared::kSurfaceWords;

} // namespace

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
    words_ = gpu::Buffer(device_, (capacity + kPagesBehind) * kPageBytes, gpu::Buffer::MemoryUsage::device,
                         "surface cache", "use a smaller --pool-mb", gpu::MemoryKind::surfaceCache);
    view_ = gpu::makeTexelView(device_, words_);
    gpu::writeTexels(device_, *set_, 0, *view_);
}

size_t SurfaceCache::roomFor(size_t pages)
{
    // In steps, so that a few pages more or less change nothing.
    constexpr size_t kStep = size_t(16) << 20;
    const size_t bytes = (pages + pages / 2) * kPageBytes;
    return (bytes + kStep - 1) / kStep * kStep;
}

void SurfaceCache::reserve(gpu::FrameRing& ring, size_t pages, size_t capBytes)
{
    // Below this many, or half as many that the view needs, it is not worth its passes.
    constexpr size_t kLeastPages = 64 * shared::kSurfaceWords;
    const auto fitting = [](size_t all) { return all - std::min(all, kPagesBehind); };
    const size_t texels = device_.limits().core.maxTexelBufferElements;
    const size_t most = fitting(std::min(capBytes / kPageBytes, texels / shared::kTileLumels));
    // Frames leave an eighth of the ring to what they add; views move on. In a ring of twice what the view
    // needs, half of the tiles that are found on an orbit had been found before.
    const size_t needed = std::min(pages + pages / 4, most), wanted = std::min(3 * pages, most);
    const size_t fewest = std::min(fitting(roomFor(pages) / kPageBytes), most);
    if (state_.capacity > most) // textures grow: not past roomFor() if they can help it
        allocate(ring, uint32_t(fewest >= kLeastPages ? fewest : 0));
    else if (needed > state_.capacity + state_.capacity / 8 && std::min(2 * pages, most) >= kLeastPages)
        allocate(ring, uint32_t(wanted));
}

} // namespace lumel
