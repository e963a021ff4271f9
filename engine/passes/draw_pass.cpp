#include "draw_pass.h"
#include <algorithm>

namespace lumel {

DrawPass::DrawPass(const gpu::Device& device, const Settings& settings, const GpuScene& scene,
                   const LitPool& pool)
{
    const bool multisampling = settings.msaa > 1 && settings.shading != Shading::reference;
    gpu::GraphicsInfo info{.vertex = "surface.vert",
                           .fragment = "draw.frag",
                           .sets = {*pool.drawLayout()},
                           .pushBytes = sizeof(shared::DrawPush),
                           .samples =
                               multisampling ? vk::SampleCountFlagBits::e4 : vk::SampleCountFlagBits::e1};
    lit_ = gpu::makeGraphicsPipeline(device, info);
    info.fragment = "forward.frag";
    info.sets = {*scene.materialLayout()};
    forward_ = gpu::makeGraphicsPipeline(device, info);
    info.blend = true;
    blended_ = gpu::makeGraphicsPipeline(device, info);
}

void DrawPass::drawObject(Frame& frame, LitPool& pool, size_t object)
{
    const vk::CommandBuffer commands = frame.commands;
    const GpuObject& o = frame.scene.objects()[object];
    const int texture = object < frame.room.objects.size() ? frame.room.objects[object].texture : -1;
    const gpu::Pipeline& pipeline = o.blend ? blended_ : texture >= 0 ? lit_ : forward_;
    commands.bindPipeline(vk::PipelineBindPoint::eGraphics, *pipeline.handle);
    commands.bindDescriptorSets(vk::PipelineBindPoint::eGraphics, *pipeline.layout, 0,
                                texture >= 0 ? *pool.texture(texture).drawSet : *o.material->set, nullptr);
    pushConstants(commands, pipeline,
                  shared::DrawPush{.view = frame.view,
                                   .object = uint32_t(object),
                                   .filterKind = uint32_t(frame.settings.filter),
                                   .level = frame.settings.shading == Shading::reference ? 0.0f : -1.0f});
    frame.scene.drawTriangles(commands, object);
}

void DrawPass::record(Frame& frame, LitPool& pool)
{
    const PassScope scope(frame, "draw");
    const vk::CommandBuffer commands = frame.commands;
    Targets& targets = frame.targets;
    const bool multisampling = bool(targets.multisampled);
    gpu::imageBarrier(commands, targets.hdr.handle(), targets.hdr.aspect(), gpu::Use::undefined,
                      gpu::Use::colorWrite);
    gpu::imageBarrier(commands, targets.depth.handle(), targets.depth.aspect(), gpu::Use::undefined,
                      gpu::Use::depthWrite);
    vk::RenderingAttachmentInfo color{.imageView = targets.hdr.view(),
                                      .imageLayout = vk::ImageLayout::eColorAttachmentOptimal,
                                      .loadOp = vk::AttachmentLoadOp::eClear,
                                      .storeOp = vk::AttachmentStoreOp::eStore};
    // The background is the environment that fills the shadows, at its horizon.
    const glm::vec3 horizon = 0.5f * (frame.scene.skyRadiance() + frame.scene.groundRadiance());
    color.clearValue = vk::ClearColorValue(std::array<float, 4>{horizon.r, horizon.g, horizon.b, 1.0f});
    if (multisampling) {
        gpu::imageBarrier(commands, targets.multisampled.handle(), targets.multisampled.aspect(),
                          gpu::Use::undefined, gpu::Use::colorWrite);
        // Resolved in linear light, like the reference's samples.
        color.imageView = targets.multisampled.view();
        color.storeOp = vk::AttachmentStoreOp::eDontCare;
        color.resolveMode = vk::ResolveModeFlagBits::eAverage;
        color.resolveImageView = targets.hdr.view();
        color.resolveImageLayout = vk::ImageLayout::eColorAttachmentOptimal;
    }
    const vk::RenderingAttachmentInfo depth{.imageView = targets.depth.view(),
                                            .imageLayout = vk::ImageLayout::eDepthAttachmentOptimal,
                                            .loadOp = vk::AttachmentLoadOp::eClear,
                                            .storeOp = vk::AttachmentStoreOp::eDontCare,
                                            .clearValue = vk::ClearDepthStencilValue{0.0f, 0}};
    commands.beginRendering({.renderArea = {{0, 0}, targets.hdr.extent()},
                             .layerCount = 1,
                             .colorAttachmentCount = 1,
                             .pColorAttachments = &color,
                             .pDepthAttachment = &depth});
    setViewport(commands, targets.hdr.extent());

    std::vector<std::pair<float, size_t>> blended; // distance, object
    const auto& objects = frame.scene.objects();
    for (size_t i = 0; i < objects.size(); ++i) {
        if (!frame.inView[i])
            continue;
        if (!objects[i].blend) {
            drawObject(frame, pool, i);
            continue;
        }
        const glm::vec3 centre =
            objects[i].data.worldFromObject * glm::vec4(objects[i].bounds.centre(), 1.0f);
        blended.emplace_back(glm::distance(centre, frame.eye), i);
    }
    std::sort(blended.begin(), blended.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
    for (const auto& [distance, object] : blended)
        drawObject(frame, pool, object);
    commands.endRendering();
}

} // namespace lumel
