// Draw: objects with a lit texture sample it; the others are shaded forward; blended ones last, back to
// front.
#pragma once
#include "lit_pool.h"

namespace lumel {

class DrawPass {
public:
    DrawPass(const gpu::Device& device, const Settings& settings, const GpuScene& scene, const LitPool& pool);
    void record(Frame& frame, const LitPool& pool);

private:
    void drawLit(Frame& frame, const LitPool& pool, size_t object);
    // opacity < 1: over what is there.
    void drawForward(Frame& frame, size_t object, float opacity);
    void drawView(Frame& frame, size_t object);
    void drawPool(Frame& frame, const LitPool& pool); // every texture, side by side
    gpu::Pipeline lit_, forward_, blended_, view_;
};

} // namespace lumel
