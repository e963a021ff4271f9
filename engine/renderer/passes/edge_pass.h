// Edge filter: where one object ends at another, pixels take the share of either that their staircase stands
// for. It shows the picture too, since it reads all of it.
#pragma once
#include "frame_context.h"
#include <map>

namespace lumel {

// Multisampling and the reference's samples need no filter; debug views show numbers.
bool filtersEdges(const Settings& settings);

class EdgePass {
public:
    EdgePass(const gpu::Device& device, const SceneState& scene, const Targets& targets);
    void connect(const gpu::Device& device, const Targets& targets); // whose picture it is to filter
    void prepare(const Frame& frame); // begins to make the pipelines of its tone mapper
    // Within the display pass: hdr as the draw pass leaves it; small or display is ready to be written.
    void record(Frame& frame);

private:
    vk::raii::Sampler sampler_;
    gpu::SetLayout layout_;
    struct Pipelines {
        gpu::Pipeline find, write;
    };
    Pipelines& pipelines(const Frame& frame);

    vk::raii::DescriptorSet set_, smallSet_ = nullptr;
    gpu::Pipeline blend_;
    std::map<uint32_t, Pipelines> pipelines_; // by tone mapper, made when first needed
    gpu::Buffer list_, pixels_;
};

} // namespace lumel
