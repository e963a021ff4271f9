// Edge filter: where one object ends at another, pixels take the share of either that their staircase stands
// for.
#pragma once
#include "frame_context.h"

namespace lumel {

// Multisampling and the reference's samples need no filter; debug views show numbers.
bool filtersEdges(const Settings& settings);

class EdgePass {
public:
    EdgePass(const gpu::Device& device, const SceneState& scene, const Targets& targets);
    void connect(const gpu::Device& device, const Targets& targets); // whose picture it is to filter
    void record(Frame& frame); // between the draw pass and what reads its picture

private:
    vk::raii::Sampler sampler_;
    gpu::SetLayout layout_;
    vk::raii::DescriptorSet set_;
    gpu::Pipeline find_, blend_, write_;
    gpu::Buffer list_, pixels_;
};

} // namespace lumel
