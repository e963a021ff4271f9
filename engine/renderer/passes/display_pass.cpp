#include "display_pass.h"
#include "gpu/sampler.h"

namespace lumel {
namespace {

// A row of groups for each row of pixels: software Vulkan divides integers one by one.
void dispatchOver(vk::CommandBuffer commands, glm::uvec2 pixels)
{
    commands.dispatch(groupsOf64(pixels.x), pixels.y, 1);
}

} // namespace

DisplayPass::DisplayPass(const gpu::Device& device, const Targets& targets)
    : sampler_(gpu::makeSampler(device, {.filter = vk::Filter::eNearest})),
      accumulateLayout_(
          gpu::makeSetLayout(device, {vk::DescriptorType::eStorageImage, vk::DescriptorType::eStorageImage})),
      displayLayout_(gpu::makeSetLayout(
          device, {vk::DescriptorType::eCombinedImageSampler, vk::DescriptorType::eStorageImage}))
{
    connect(device, targets);
}

// Software Vulkan would run every tone mapper at every pixel, were they branches.
const gpu::Pipeline& DisplayPass::pipeline(const gpu::Device& device, const SceneState& scene,
                                           uint32_t toneMap)
{
    gpu::Pipeline& display = display_[toneMap];
    if (!display.handle.begun())
        display =
            gpu::makeComputePipeline(device, "display.comp", {*scene.frameSet().layout(), *displayLayout_},
                                     sizeof(shared::DisplayPush), toneMap);
    return display;
}

void DisplayPass::prepare(const Frame& frame)
{
    const auto make = [&](gpu::Pipeline& pipeline, const char* shader, const gpu::SetLayout& layout,
                          uint32_t pushBytes) {
        if (!pipeline.handle.begun())
            pipeline = gpu::makeComputePipeline(frame.device, shader,
                                                {*frame.scene.frameSet().layout(), *layout}, pushBytes);
    };
    if (!filtersEdges(frame.settings)) // which tone-maps too
        pipeline(frame.device, frame.scene, uint32_t(frame.settings.toneMap));
    if (frame.targets.sum)
        make(accumulate_, "accumulate.comp", accumulateLayout_, sizeof(shared::DisplayPush));
    if (frame.targets.small) {
        make(upscaleX_, "upscale_x.comp", displayLayout_, sizeof(shared::ScalePush));
        make(upscaleY_, "upscale_y.comp", displayLayout_, sizeof(shared::ScalePush));
    }
}

void DisplayPass::connect(const gpu::Device& device, const Targets& targets)
{
    const auto between = [&](const gpu::Image& from, const gpu::Image& to) {
        auto set = gpu::makeSet(device, displayLayout_);
        gpu::writeSampled(device, *set, 0, *sampler_, from.view());
        gpu::writeStorage(device, *set, 1, to.view());
        return set;
    };
    hdrSet_ = between(targets.hdr, targets.display);
    if (targets.small) {
        smallSet_ = between(targets.hdr, targets.small);
        upscaleXSet_ = between(targets.small, targets.wide);
        upscaleYSet_ = between(targets.wide, targets.display);
    }
    if (!targets.sum)
        return;
    sumSet_ = between(targets.sum, targets.display);
    accumulateSet_ = gpu::makeSet(device, accumulateLayout_);
    gpu::writeStorage(device, *accumulateSet_, 0, targets.hdr.view());
    gpu::writeStorage(device, *accumulateSet_, 1, targets.sum.view());
}

void DisplayPass::clearSum(Frame& frame)
{
    const gpu::Image& sum = frame.targets.sum;
    gpu::imageBarrier(frame.commands, sum.handle(), sum.aspect(), gpu::Use::undefined,
                      gpu::Use::transferWrite);
    frame.commands.clearColorImage(sum.handle(), vk::ImageLayout::eTransferDstOptimal, vk::ClearColorValue{},
                                   vk::ImageSubresourceRange{sum.aspect(), 0, 1, 0, 1});
    gpu::imageBarrier(frame.commands, sum.handle(), sum.aspect(), gpu::Use::transferWrite,
                      gpu::Use::computeReadWrite);
}

void DisplayPass::resumeSum(Frame& frame)
{
    const gpu::Image& sum = frame.targets.sum;
    gpu::imageBarrier(frame.commands, sum.handle(), sum.aspect(), gpu::Use::transferRead,
                      gpu::Use::computeReadWrite);
}

void DisplayPass::accumulate(Frame& frame)
{
    const gpu::Image& hdr = frame.targets.hdr;
    gpu::imageBarrier(frame.commands, hdr.handle(), hdr.aspect(), gpu::Use::colorWrite,
                      gpu::Use::computeRead);
    gpu::memoryBarrier(frame.commands, gpu::Use::computeReadWrite, gpu::Use::computeReadWrite);
    bindSets(frame, vk::PipelineBindPoint::eCompute, accumulate_, {*accumulateSet_});
    pushConstants(frame.commands, accumulate_, shared::DisplayPush{.weight = 1.0f, .size = frame.renderSize});
    dispatchOver(frame.commands, frame.settings.size);
}

void DisplayPass::recordUpscale(Frame& frame)
{
    const glm::uvec2 size = frame.settings.size, from = frame.renderSize, blocks = (size + 3u) / 4u;
    const auto scale = [&](const gpu::Image& source, const gpu::Pipeline& pipeline, vk::DescriptorSet set,
                           glm::uvec2 invocations) {
        gpu::imageBarrier(frame.commands, source.handle(), source.aspect(), gpu::Use::computeWrite,
                          gpu::Use::computeSample);
        bindSets(frame, vk::PipelineBindPoint::eCompute, pipeline, {set});
        pushConstants(frame.commands, pipeline, shared::ScalePush{.from = from, .to = size});
        dispatchOver(frame.commands, invocations);
    };
    scale(frame.targets.small, upscaleX_, *upscaleXSet_, {blocks.x, from.y});
    scale(frame.targets.wide, upscaleY_, *upscaleYSet_, blocks);
}

void DisplayPass::recordToneMapping(Frame& frame, int sampleCount)
{
    const vk::CommandBuffer commands = frame.commands;
    const gpu::Image& source = sampleCount ? frame.targets.sum : frame.targets.hdr;
    gpu::imageBarrier(commands, source.handle(), source.aspect(),
                      sampleCount ? gpu::Use::computeReadWrite : gpu::Use::colorWrite,
                      gpu::Use::computeSample);
    const gpu::Pipeline& toneMapped = pipeline(frame.device, frame.scene, uint32_t(frame.settings.toneMap));
    bindSets(frame, vk::PipelineBindPoint::eCompute, toneMapped,
             {frame.renderSize != frame.settings.size ? *smallSet_
              : sampleCount                           ? *sumSet_
                                                      : *hdrSet_});
    pushConstants(
        commands, toneMapped,
        shared::DisplayPush{.weight = 1.0f / float(std::max(sampleCount, 1)), .size = frame.renderSize});
    dispatchOver(commands, {frame.renderSize.x,
                            (frame.renderSize.y + shared::kDisplayRows - 1) / shared::kDisplayRows});
}

void DisplayPass::record(Frame& frame, int sampleCount, EdgePass* edges)
{
    const PassScope scope(frame, "display");
    const vk::CommandBuffer commands = frame.commands;
    const gpu::Image& source = sampleCount ? frame.targets.sum : frame.targets.hdr;
    const gpu::Image& display = frame.targets.display;
    gpu::imageBarrier(commands, display.handle(), display.aspect(), gpu::Use::undefined,
                      gpu::Use::computeWrite);
    const bool small = frame.renderSize != frame.settings.size;
    if (small)
        for (const gpu::Image* image : {&frame.targets.small, &frame.targets.wide})
            gpu::imageBarrier(commands, image->handle(), image->aspect(), gpu::Use::undefined,
                              gpu::Use::computeWrite);
    if (edges)
        edges->record(frame);
    else
        recordToneMapping(frame, sampleCount);
    if (small)
        recordUpscale(frame);
    gpu::imageBarrier(commands, source.handle(), source.aspect(), gpu::Use::computeSample,
                      gpu::Use::transferRead);
    gpu::imageBarrier(commands, display.handle(), display.aspect(), gpu::Use::computeWrite,
                      gpu::Use::transferRead);
}

} // namespace lumel
