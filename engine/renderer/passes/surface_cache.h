// What lighting needs of lumels' surfaces, kept for tiles that are lit again: shaders/lib/surface_cache.glsl.
// A ring of slots, a tile each; the oldest is given to the next tile that needs one.
#pragma once
#include "frame_context.h"

namespace lumel {

class SurfaceCache {
public:
    explicit SurfaceCache(const gpu::Device& device);

    // Room for `tiles`, within so many bytes; never smaller than it is while it fits. What it held is lost
    // when it is reallocated, which waits for the frames in flight.
    void reserve(gpu::FrameRing& ring, size_t tiles, size_t capBytes);
    // Bytes that are to be left to it, when so many tiles are in view.
    static size_t roomFor(size_t tiles);
    void clear(gpu::FrameRing& ring) { reserve(ring, 0, 0); }

    uint32_t capacity() const { return state_.capacity; } // tiles
    // For the plan of the next frame, which it is told once that the memory is new.
    shared::SurfaceCacheState next() { return {state_.capacity, std::exchange(state_.emptied, 0u)}; }
    vk::DeviceAddress address() const { return words_ ? words_.address() : 0; }
    size_t bytes() const { return state_.capacity * kTileBytes; }
    // Binding 0: the words as a uniform texel buffer.
    const gpu::SetLayout& layout() const { return layout_; }
    vk::DescriptorSet set() const { return *set_; }

    static constexpr size_t kTileBytes = shared::kTileLumels * shared::kSurfaceWords * sizeof(glm::uvec4);

private:
    void allocate(gpu::FrameRing& ring, uint32_t capacity);
    const gpu::Device& device_;
    gpu::SetLayout layout_;
    vk::raii::DescriptorSet set_ = nullptr;
    gpu::Buffer words_;
    vk::raii::BufferView view_ = nullptr;
    shared::SurfaceCacheState state_{};
};

} // namespace lumel
