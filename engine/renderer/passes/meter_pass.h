// Meter: the luminances of the picture, counted, for automatic exposure.
#pragma once
#include "core/exposure.h"
#include "frame_context.h"

namespace lumel {

class MeterPass {
public:
    MeterPass(const gpu::Device& device, const SceneState& scene);
    // hdr's part of renderSize, just drawn: what is covered by a surface or the environment.
    void record(Frame& frame);
    LuminanceHistogram read() const; // after the recorded commands have finished

private:
    vk::raii::Sampler sampler_;
    gpu::SetLayout layout_;
    vk::raii::DescriptorSet set_;
    gpu::Pipeline pipeline_;
    gpu::Counters histogram_;
};

} // namespace lumel
