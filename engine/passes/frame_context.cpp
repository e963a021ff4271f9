#include "frame_context.h"

namespace lumel {

Targets::Targets(const gpu::Device& device, const Settings& settings)
{
    using Usage = vk::ImageUsageFlagBits;
    const uint32_t width = settings.size.x, height = settings.size.y;
    const bool multisampling = settings.msaa > 1 && settings.shading != Shading::reference;
    const auto samples = multisampling ? vk::SampleCountFlagBits::e4 : vk::SampleCountFlagBits::e1;
    hdr = gpu::Image(
        device,
        {.width = width,
         .height = height,
         .usage = Usage::eColorAttachment | Usage::eSampled | Usage::eStorage | Usage::eTransferSrc},
        "hdr");
    depth = gpu::Image(device,
                       {.format = vk::Format::eD32Sfloat,
                        .width = width,
                        .height = height,
                        .usage = Usage::eDepthStencilAttachment,
                        .samples = samples},
                       "depth");
    if (multisampling)
        multisampled = gpu::Image(
            device, {.width = width, .height = height, .usage = Usage::eColorAttachment, .samples = samples},
            "multisampled");
    if (settings.shading == Shading::reference)
        sum = gpu::Image(
            device,
            {.format = vk::Format::eR32G32B32A32Sfloat,
             .width = width,
             .height = height,
             .usage = Usage::eStorage | Usage::eSampled | Usage::eTransferSrc | Usage::eTransferDst},
            "reference sum");
    if (settings.budgetMs > 0.0)
        for (gpu::Image* image : {&small, &wide})
            *image = gpu::Image(
                device, {.width = width, .height = height, .usage = Usage::eStorage | Usage::eSampled},
                image == &small ? "small picture" : "wide picture");
    display = gpu::Image(device,
                         {.format = vk::Format::eR8G8B8A8Unorm,
                          .width = width,
                          .height = height,
                          .usage = Usage::eStorage | Usage::eTransferSrc},
                         "display");
}

void bindSets(Frame& frame, vk::PipelineBindPoint point, const gpu::Pipeline& pipeline,
              std::initializer_list<vk::DescriptorSet> sets)
{
    std::vector<vk::DescriptorSet> all{frame.scene.frameSet()};
    all.insert(all.end(), sets);
    frame.commands.bindPipeline(point, *pipeline.handle);
    frame.commands.bindDescriptorSets(point, *pipeline.layout, 0, all, nullptr);
}

void setViewport(vk::CommandBuffer commands, vk::Extent2D extent)
{
    commands.setViewport(
        0, vk::Viewport{
               .width = float(extent.width), .height = float(extent.height), .minDepth = 0, .maxDepth = 1});
    commands.setScissor(0, vk::Rect2D{{0, 0}, extent});
}

} // namespace lumel
