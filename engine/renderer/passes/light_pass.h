// Light: the planned tiles, by compute, a dispatch per material and pool block. Lower levels: coarser tiles
// from their lit children, a dispatch per block and MIP,
// one for the last MIPs together.
#pragma once
#include "plan_pass.h"

namespace lumel {

class LightPass {
public:
    LightPass(const gpu::Device& device, const SceneState& scene, const LitPool& pool);
    // Begins to make all pipelines that the scene can need, with the lights' kFeature...
    void prepare(const Frame& frame, const LitPool& pool, uint32_t lights);
    // No first frame finds a surface in the cache.
    void prepareCached(const Frame& frame, const LitPool& pool, const PlanPass& plan, uint32_t lights);
    void recordLight(Frame& frame, const LitPool& pool, const PlanPass& plan);
    void recordLower(Frame& frame, const LitPool& pool, const PlanPass& plan);

private:
    // Made when first needed and kept.
    const gpu::Pipeline& lightPipeline(const Frame& frame, const LitPool& pool, uint32_t features);
    const gpu::Pipeline& cachedPipeline(const Frame& frame, const LitPool& pool, const SurfaceCache& surfaces,
                                        uint32_t features);

    std::map<uint32_t, gpu::Pipeline> light_, cached_; // by features
    gpu::Pipeline lower_, lowerTail_;
};

} // namespace lumel
