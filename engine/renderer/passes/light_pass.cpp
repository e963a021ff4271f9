#include "light_pass.h"

namespace lumel {

LightPass::LightPass(const gpu::Device& device, const SceneState& scene, const LitPool& pool)
    : lower_(gpu::makeComputePipeline(device, "lower.comp", {*scene.frameSet().layout(), *pool.layout()},
                                      sizeof(shared::LightPush))),
      lowerTail_(gpu::makeComputePipeline(device, "lower.comp", {*scene.frameSet().layout(), *pool.layout()},
                                          sizeof(shared::LightPush), shared::kFeatureTail))
{
}

const gpu::Pipeline& LightPass::lightPipeline(const Frame& frame, const LitPool& pool, uint32_t features)
{
    gpu::Pipeline& pipeline = light_[features];
    if (!pipeline.handle.begun())
        pipeline = gpu::makeComputePipeline(frame.device, "light.comp",
                                            {*frame.scene.frameSet().layout(), *frame.scene.materialLayout(),
                                             *pool.layout(), *frame.scene.vertexTexelLayout()},
                                            sizeof(shared::LightPush), features);
    return pipeline;
}

const gpu::Pipeline& LightPass::cachedPipeline(const Frame& frame, const LitPool& pool,
                                               const SurfaceCache& surfaces, uint32_t features)
{
    gpu::Pipeline& pipeline = cached_[features];
    if (!pipeline.handle.begun())
        pipeline =
            gpu::makeComputePipeline(frame.device, "light_cached.comp",
                                     {*frame.scene.frameSet().layout(), *surfaces.layout(), *pool.layout()},
                                     sizeof(shared::LightPush), features);
    return pipeline;
}

void LightPass::prepare(const Frame& frame, const LitPool& pool, uint32_t lights)
{
    for (const SurfaceKind& kind : frame.scene.surfaceKinds())
        if (kind.lightable)
            lightPipeline(frame, pool, lights | kind.features);
}

void LightPass::prepareCached(const Frame& frame, const LitPool& pool, const PlanPass& plan, uint32_t lights)
{
    for (const SurfaceKind& kind : frame.scene.surfaceKinds())
        for (const uint32_t shadows : {shared::kFeatureKnownShadows, 0u})
            if (kind.lightable)
                cachedPipeline(frame, pool, plan.surfaces(),
                               lights | shadows | (kind.features & shared::kFeatureSecondLobe));
}

// kFeature... beside the lights'.
static uint32_t featuresOf(const PlanPass::LightJob& job)
{
    using Surface = PlanPass::Surface;
    return (job.material ? materialFeatures(*job.material) : 0u) |
           (job.twoLobes ? shared::kFeatureSecondLobe : 0u) |
           (job.surface == Surface::coloured ? shared::kFeatureColoured : 0u) |
           (job.surface == Surface::cachedAndShadows ? shared::kFeatureKnownShadows : 0u);
}

void LightPass::recordLight(Frame& frame, const LitPool& pool, const PlanPass& plan)
{
    const PassScope scope(frame, "light");
    const vk::CommandBuffer commands = frame.commands;
    const SurfaceCache& surfaces = plan.surfaces();
    const uint32_t lights = frame.scene.lights().features();
    for (uint32_t i = 0; i < plan.lightJobs().size(); ++i) {
        const PlanPass::LightJob& job = plan.lightJobs()[i];
        if (!job.material && surfaces.capacity() == 0)
            continue;
        const uint32_t features = lights | featuresOf(job);
        const gpu::Pipeline& light = job.material ? lightPipeline(frame, pool, features)
                                                  : cachedPipeline(frame, pool, surfaces, features);
        const vk::DescriptorSet lit = *pool.blocks()[size_t(job.block)].set;
        constexpr auto kCompute = vk::PipelineBindPoint::eCompute;
        if (job.material)
            bindSets(frame, kCompute, light, {*job.material->set, lit, job.vertices});
        else
            bindSets(frame, kCompute, light, {surfaces.set(), lit});
        pushConstants(commands, light, plan.push(i));
        commands.dispatchIndirect(plan.jobBuffer(), i * sizeof(shared::Job));
    }
    gpu::memoryBarrier(commands, gpu::Use::computeWrite, gpu::Use::general); // cached surfaces are sampled
}

void LightPass::recordLower(Frame& frame, const LitPool& pool, const PlanPass& plan)
{
    const PassScope scope(frame, "lower");
    const vk::CommandBuffer commands = frame.commands;
    bool more = true;
    for (uint32_t mip = 1; more; ++mip) {
        more = false;
        for (const PlanPass::LowerJobs& block : plan.lowerJobs()) {
            if (mip > block.capacity.size())
                continue;
            more = true;
            const uint32_t job = block.job + mip - 1;
            const gpu::Pipeline& lower = mip < block.capacity.size() ? lower_ : lowerTail_;
            bindSets(frame, vk::PipelineBindPoint::eCompute, lower,
                     {*pool.blocks()[size_t(block.block)].set});
            pushConstants(commands, lower, plan.push(job));
            commands.dispatchIndirect(plan.jobBuffer(), job * sizeof(shared::Job));
        }
        gpu::memoryBarrier(commands, gpu::Use::computeWrite, gpu::Use::computeReadWrite);
    }
    gpu::memoryBarrier(commands, gpu::Use::computeWrite, gpu::Use::general);
}

} // namespace lumel
