// Need: which level of each object's lit texture does this view need? Quarter resolution, one offset of a
// 4 x 4 sub-pixel cycle a frame.
#pragma once
#include "frame_context.h"

namespace lumel {

class NeedPass {
public:
    static constexpr uint32_t kDivisor = 4;
    NeedPass(const gpu::Device& device, glm::uvec2 size, size_t objectCount);
    void record(Frame& frame);
    // Fills frame.needs after the recorded commands have finished.
    void read(Frame& frame) const;

private:
    gpu::Image seen_, depth_;
    gpu::SetLayout layout_;
    vk::raii::DescriptorSet set_;
    gpu::Pipeline raster_, mark_;
    gpu::Buffer needs_;
};

} // namespace lumel
