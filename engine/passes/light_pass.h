// Light: the planned tiles, by compute, a dispatch per material and pool block. Lower levels: coarser tiles
// from their lit children, a dispatch per block and MIP.
#pragma once
#include "plan_pass.h"

namespace lumel {

class LightPass {
public:
    LightPass(const gpu::Device& device, const GpuScene& scene, const LitPool& pool);
    void recordLight(Frame& frame, const LitPool& pool, const PlanPass& plan);
    void recordLower(Frame& frame, const LitPool& pool, const PlanPass& plan);

private:
    gpu::Pipeline light_, lower_;
    gpu::Pipeline colouredLight_; // made when the first vertex colours are lit
};

} // namespace lumel
