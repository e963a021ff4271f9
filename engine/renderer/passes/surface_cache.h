// What lighting needs of lumels' surfaces, kept for tiles that are lit again: shaders/lib/surface_cache.glsl.
// A ring of pages, of which a tile has several; the oldest are given to the next tile that needs some.
#pragma once
#include "frame_context.h"

namespace lumel {

class SurfaceCache {
public:
    explicit SurfaceCache(const gpu::Device& device);

    // Room for so many pages in view, within so many bytes; never smaller than it is while it fits. What it
    // held is lost when it is reallocated, which waits for the frames in flight.
    void reserve(gpu::FrameRing& ring, size_t pages, size_t capBytes);
    // Bytes that are to be left to it, when so many pages are in view.
    static size_t roomFor(size_t pages);
    void clear(gpu::FrameRing& ring) { reserve(ring, 0, 0); }

    uint32_t capacity() const { return state_.capacity; } // pages
    // For the plan of the next frame, which it is told once that the memory is new.
    shared::SurfaceCacheState next() { return {state_.capacity, std::exchange(state_.emptied, 0u)}; }
    vk::DeviceAddress address() const { return words_ ? words_.address() : 0; }
    size_t bytes() const { return words_.size(); }
    // Binding 0: the words as a uniform texel buffer.
    const gpu::SetLayout& layout() const { return layout_; }
    vk::DescriptorSet set() const { return *set_; }

    static constexpr size_t kPageBytes = shared::kTileLumels * sizeof(glm::uvec4);

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
