// Set 0 of every pipeline: the view, the lights, the environment map, the shadow maps and the object table.
// Frames in flight have one each.
#pragma once
#include "gpu/frame_ring.h"
#include "gpu/pipeline.h"
#include "gpu/resource.h"
#include "shared/structs.h"
#include <array>
#include <span>

namespace lumel {

class FrameSet {
public:
    FrameSet(const gpu::Device& device, size_t objects);

    // The place that the next frame has. What follows is about it.
    void begin(uint32_t place);
    uint32_t place() const { return place_; }
    const gpu::SetLayout& layout() const { return layout_; }
    vk::DescriptorSet handle() const { return *current().set; }
    vk::Buffer viewBuffer() const { return current().view.handle(); }
    const gpu::Buffer& objectTable() const { return current().objects; } // only write to it

    void writeView(const shared::View& view) { current().view.write(std::span(&view, 1)); }
    // The same as a command, for several views in a submission.
    void recordView(vk::CommandBuffer commands, const shared::View& view) const;
    void writeLights(std::span<const shared::Light> lights) // at most kMaxLights
    {
        current().lights.write(lights);
    }

    // Of all places: call these when no frame is in flight.
    void bindEnvironment(vk::ImageView map);
    void bindShadows(vk::Sampler sampler, vk::ImageView maps);

private:
    struct Place { // made when first needed
        vk::raii::DescriptorSet set = nullptr;
        gpu::Buffer view, lights, objects;
        vk::raii::BufferView objectTexels = nullptr;
    };
    Place& current() { return places_[place_]; }
    const Place& current() const { return places_[place_]; }
    void bindMaps(const Place& place) const;

    const gpu::Device& device_;
    gpu::SetLayout layout_;
    vk::raii::Sampler environmentSampler_;
    size_t objectBytes_;
    vk::ImageView environment_, shadows_;
    vk::Sampler shadowSampler_;
    std::array<Place, gpu::FrameRing::kMostFrames> places_;
    uint32_t place_ = 0;
};

} // namespace lumel
