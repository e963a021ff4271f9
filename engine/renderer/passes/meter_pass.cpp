#include "meter_pass.h"
#include "gpu/sampler.h"

namespace lumel {

MeterPass::MeterPass(const gpu::Device& device, const SceneState& scene)
    : sampler_(gpu::makeSampler(device, {.filter = vk::Filter::eNearest})),
      layout_(gpu::makeSetLayout(device, {vk::DescriptorType::eCombinedImageSampler})),
      set_(gpu::makeSet(device, layout_)),
      pipeline_(gpu::makeComputePipeline(device, "meter.comp", {*scene.frameSet().layout(), *layout_},
                                         sizeof(shared::MeterPush))),
      histogram_(device, std::vector{LuminanceHistogram{}}, "luminance histogram")
{
}

void MeterPass::record(Frame& frame)
{
    const PassScope scope(frame, "meter");
    const gpu::Image& hdr = frame.targets.hdr;
    gpu::writeSampled(frame.device, *set_, 0, *sampler_, hdr.view());
    gpu::Counters::recordReset(frame.commands, {&histogram_});
    gpu::imageBarrier(frame.commands, hdr.handle(), hdr.aspect(), gpu::Use::colorWrite,
                      gpu::Use::computeSample);
    bindSets(frame, vk::PipelineBindPoint::eCompute, pipeline_, {*set_});
    pushConstants(frame.commands, pipeline_,
                  shared::MeterPush{.histogram = histogram_.address(), .size = frame.renderSize});
    const uint32_t strips = (frame.renderSize.y + shared::kMeterRows - 1) / shared::kMeterRows;
    frame.commands.dispatch(groupsOf64(frame.renderSize.x), strips, 1);
    gpu::Counters::recordRead(frame.commands, {&histogram_});
}

LuminanceHistogram MeterPass::read() const
{
    return *histogram_.read<LuminanceHistogram>();
}

} // namespace lumel
