// Display: radiance to display colour, once, upscaled where the frame is smaller; and the sum of shifted
// frames behind the reference.
#pragma once
#include "edge_pass.h"
#include <map>

namespace lumel {

class DisplayPass {
public:
    DisplayPass(const gpu::Device& device, const Targets& targets);
    void connect(const gpu::Device& device, const Targets& targets); // to targets of another size
    void prepare(const Frame& frame); // begins to make the pipelines of its settings
    void clearSum(Frame& frame);
    void resumeSum(Frame& frame);  // after record(): more is to be added
    void accumulate(Frame& frame); // adds hdr to the sum
    // sampleCount 0: shows hdr's part of renderSize, by `edges` where it is filtered; else the sum's mean.
    void record(Frame& frame, int sampleCount, EdgePass* edges);

private:
    // To display by kToneMap...
    const gpu::Pipeline& pipeline(const gpu::Device& device, const SceneState& scene, uint32_t toneMap);
    void recordToneMapping(Frame& frame, int sampleCount);
    void recordUpscale(Frame& frame);

    vk::raii::Sampler sampler_;
    gpu::SetLayout accumulateLayout_, displayLayout_;
    vk::raii::DescriptorSet accumulateSet_ = nullptr, hdrSet_ = nullptr, sumSet_ = nullptr;
    vk::raii::DescriptorSet smallSet_ = nullptr, upscaleXSet_ = nullptr, upscaleYSet_ = nullptr;
    gpu::Pipeline accumulate_, upscaleX_, upscaleY_;
    std::map<uint32_t, gpu::Pipeline> display_; // by tone mapper, made when first needed
};

} // namespace lumel
