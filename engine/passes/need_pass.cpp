#include "need_pass.h"

namespace lumel {
namespace {

gpu::Image makeTarget(const gpu::Device& device, glm::uvec2 size, vk::Format format,
                      vk::ImageUsageFlags usage)
{
    return {device, {.format = format, .width = size.x, .height = size.y, .usage = usage}, "need"};
}

// Offset of sample centres in full-size pixels from the quarter pixel's centre: the 16 pixels of a 4 x 4
// block in an order that spreads (bit-reversed Morton).
glm::vec2 jitterInPixels(uint64_t frame)
{
    constexpr int kOrder[16] = {0, 10, 2, 8, 5, 15, 7, 13, 1, 11, 3, 9, 4, 14, 6, 12};
    const int cell = kOrder[frame % 16];
    return {float(cell % 4) - 1.5f, float(cell / 4) - 1.5f};
}

} // namespace

NeedPass::NeedPass(const gpu::Device& device, glm::uvec2 size, const GpuScene& scene)
    : layout_(gpu::makeSetLayout(device, {vk::DescriptorType::eStorageImage})),
      set_(gpu::makeSet(device, layout_)),
      raster_(gpu::makeGraphicsPipeline(device, {.vertex = "need.vert",
                                                 .fragment = "need.frag",
                                                 .sets = {*scene.frameLayout()},
                                                 .pushBytes = sizeof(shared::NeedPush),
                                                 .color = vk::Format::eR32G32B32A32Uint})),
      mark_(gpu::makeComputePipeline(device, "need.comp", {*scene.frameLayout(), *layout_},
                                     sizeof(shared::NeedPush))),
      needs_(device, scene.objects().size() * sizeof(shared::Need), gpu::Buffer::Home::host, "needs")
{
    resize(device, size);
}

void NeedPass::resize(const gpu::Device& device, glm::uvec2 size)
{
    using Usage = vk::ImageUsageFlagBits;
    seen_ =
        makeTarget(device, size, vk::Format::eR32G32B32A32Uint, Usage::eColorAttachment | Usage::eStorage);
    depth_ = makeTarget(device, size, vk::Format::eD32Sfloat, Usage::eDepthStencilAttachment);
    gpu::writeStorage(device, *set_, 0, seen_.view());
}

void NeedPass::record(Frame& frame, bool everyPixel)
{
    divisor_ = everyPixel ? 1 : kDivisor;
    samples_ = (frame.renderSize + divisor_ - 1u) / divisor_;
    const PassScope scope(frame, "need");
    const size_t count = frame.scene.objects().size();
    auto* needs = needs_.mapped<shared::Need>();
    std::fill(needs, needs + count, shared::Need{shared::kNotSeen, 0, 0});

    const vk::CommandBuffer commands = frame.commands;
    const vk::Extent2D extent{samples_.x, samples_.y}; // a part of the images
    gpu::imageBarrier(commands, seen_.handle(), seen_.aspect(), gpu::Use::undefined, gpu::Use::colorWrite);
    gpu::imageBarrier(commands, depth_.handle(), depth_.aspect(), gpu::Use::undefined, gpu::Use::depthWrite);
    const vk::RenderingAttachmentInfo color{.imageView = seen_.view(),
                                            .imageLayout = vk::ImageLayout::eColorAttachmentOptimal,
                                            .loadOp = vk::AttachmentLoadOp::eClear,
                                            .storeOp = vk::AttachmentStoreOp::eStore};
    const vk::RenderingAttachmentInfo depth{.imageView = depth_.view(),
                                            .imageLayout = vk::ImageLayout::eDepthAttachmentOptimal,
                                            .loadOp = vk::AttachmentLoadOp::eClear,
                                            .storeOp = vk::AttachmentStoreOp::eDontCare,
                                            .clearValue = vk::ClearDepthStencilValue{0.0f, 0}};
    commands.beginRendering({.renderArea = {{0, 0}, extent},
                             .layerCount = 1,
                             .colorAttachmentCount = 1,
                             .pColorAttachments = &color,
                             .pDepthAttachment = &depth});
    setViewport(commands, extent);
    bindSets(frame, vk::PipelineBindPoint::eGraphics, raster_);
    // Quarter pixels cover whole blocks of 4 x 4, also where the picture's size is not a multiple of 4: the
    // viewport reaches past its edge by the same share, which is at most three pixels.
    const glm::vec2 pixels = everyPixel ? glm::vec2(0.0f) : jitterInPixels(frame.index);
    const glm::vec2 jitter = 2.0f * pixels / glm::vec2(frame.renderSize);
    shared::NeedPush push{.needs = needs_.address(),
                          .jitter = jitter,
                          .divisor = float(divisor_),
                          .object = 0,
                          .size = samples_};
    for (size_t i = 0; i < count; ++i) {
        if (!frame.inView[i] || frame.scene.objects()[i].blend)
            continue;
        push.object = uint32_t(i);
        pushConstants(commands, raster_, push);
        frame.scene.drawTriangles(commands, i);
    }
    commands.endRendering();

    gpu::imageBarrier(commands, seen_.handle(), seen_.aspect(), gpu::Use::colorWrite, gpu::Use::computeRead);
    bindSets(frame, vk::PipelineBindPoint::eCompute, mark_, {*set_});
    pushConstants(commands, mark_, push);
    commands.dispatch(groupsOf64(extent.width * extent.height), 1, 1);
    gpu::memoryBarrier(commands, gpu::Use::computeWrite, gpu::Use::hostRead);
}

void NeedPass::read(Frame& frame) const
{
    const auto* needs = needs_.mapped<shared::Need>();
    const auto& objects = frame.scene.objects();
    frame.needs.resize(objects.size());
    for (size_t i = 0; i < objects.size(); ++i)
        frame.needs[i] = {.inView = frame.inView[i] != 0,
                          .visible = needs[i].level != shared::kNotSeen,
                          .lightable = objects[i].texelMap != nullptr,
                          .level = float(needs[i].level) / float(shared::kNeedScale) + shared::kNeedFinest,
                          .samples = needs[i].samples,
                          .lumels = float(needs[i].lumels) / float(shared::kNeedScale),
                          .litSize = objects[i].data.litSize};
}

} // namespace lumel
