// Draw: objects with a lit texture sample it; the others are shaded forward; blended ones last, back to
// front.
#pragma once
#include "lit_pool.h"

namespace lumel {

class DrawPass {
public:
    DrawPass(const gpu::Device& device, const Settings& settings, const GpuScene& scene, const LitPool& pool);
    void record(Frame& frame, LitPool& pool);

private:
    void drawObject(Frame& frame, LitPool& pool, size_t object);
    gpu::Pipeline lit_, forward_, blended_;
};

} // namespace lumel
