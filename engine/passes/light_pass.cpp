#include "light_pass.h"

namespace lumel {
namespace {

gpu::Pipeline makeLightPipeline(const gpu::Device& device, const GpuScene& scene, const LitPool& pool,
                                bool coloured)
{
    return gpu::makeComputePipeline(device, "light.comp",
                                    {*scene.frameLayout(), *scene.materialLayout(), *pool.layout()},
                                    sizeof(shared::LightPush), coloured);
}

} // namespace

LightPass::LightPass(const gpu::Device& device, const GpuScene& scene, const LitPool& pool)
    : light_(makeLightPipeline(device, scene, pool, false)),
      lower_(gpu::makeComputePipeline(device, "lower.comp", {*scene.frameLayout(), *pool.layout()},
                                      sizeof(shared::LightPush)))
{
}

void LightPass::recordLight(Frame& frame, const LitPool& pool, const PlanPass& plan)
{
    const PassScope scope(frame, "light");
    const vk::CommandBuffer commands = frame.commands;
    for (uint32_t i = 0; i < plan.lightJobs().size(); ++i) {
        const PlanPass::LightJob& job = plan.lightJobs()[i];
        if (job.coloured && !*colouredLight_.handle)
            colouredLight_ = makeLightPipeline(frame.device, frame.scene, pool, true);
        const gpu::Pipeline& light = job.coloured ? colouredLight_ : light_;
        bindSets(frame, vk::PipelineBindPoint::eCompute, light,
                 {*job.material->set, *pool.blocks()[size_t(job.block)].set});
        pushConstants(commands, light, plan.push(i));
        commands.dispatchIndirect(plan.jobBuffer(), i * sizeof(shared::Job));
    }
    gpu::memoryBarrier(commands, gpu::Use::computeWrite, gpu::Use::computeReadWrite);
}

void LightPass::recordLower(Frame& frame, const LitPool& pool, const PlanPass& plan)
{
    const PassScope scope(frame, "lower");
    const vk::CommandBuffer commands = frame.commands;
    bool more = true;
    for (uint32_t mip = 1; more; ++mip) {
        more = false;
        for (const PlanPass::LowerJobs& block : plan.lowerJobs()) {
            if (mip >= block.mips)
                continue;
            more = true;
            const uint32_t job = block.job + mip - 1;
            bindSets(frame, vk::PipelineBindPoint::eCompute, lower_,
                     {*pool.blocks()[size_t(block.block)].set});
            pushConstants(commands, lower_, plan.push(job));
            commands.dispatchIndirect(plan.jobBuffer(), job * sizeof(shared::Job));
        }
        gpu::memoryBarrier(commands, gpu::Use::computeWrite, gpu::Use::computeReadWrite);
    }
    gpu::memoryBarrier(commands, gpu::Use::computeWrite, gpu::Use::general);
}

} // namespace lumel
