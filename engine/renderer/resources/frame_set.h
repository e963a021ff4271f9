// Set 0 of every pipeline: the view, the lights, the environment map, the shadow maps and the
// object table. Frames are waited
// for, so one set serves all.
#pragma once
#include "gpu/pipeline.h"
#include "gpu/resource.h"
#include "shared/structs.h"
#include <span>

namespace lumel {

class FrameSet {
public:
    explicit FrameSet(const gpu::Device& device);

    const gpu::SetLayout& layout() const { return layout_; }
    vk::DescriptorSet handle() const { return *set_; }
    vk::Buffer viewBuffer() const { return view_.handle(); }

    // Call these when no frame is in flight.
    void writeView(const shared::View& view) { view_.write(std::span(&view, 1)); }
    // The same as a command, for several views in a submission.
    void recordView(vk::CommandBuffer commands, const shared::View& view) const;
    void writeLights(std::span<const shared::Light> lights) // at most kMaxLights
    {
        lights_.write(lights);
    }
    void bindEnvironment(const gpu::Device& device, vk::ImageView map);
    void bindObjects(const gpu::Device& device, vk::BufferView table);
    void bindShadows(const gpu::Device& device, vk::Sampler sampler, vk::ImageView maps);

private:
    gpu::SetLayout layout_;
    vk::raii::DescriptorSet set_;
    vk::raii::Sampler environmentSampler_;
    gpu::Buffer view_, lights_;
};

} // namespace lumel
