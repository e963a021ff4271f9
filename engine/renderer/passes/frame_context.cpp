#include "frame_context.h"

namespace lumel {

void bindSets(Frame& frame, vk::PipelineBindPoint point, const gpu::Pipeline& pipeline,
              std::initializer_list<vk::DescriptorSet> sets)
{
    std::vector<vk::DescriptorSet> all{frame.scene.frameSet().handle()};
    all.insert(all.end(), sets);
    frame.commands.bindPipeline(point, *pipeline.handle);
    frame.commands.bindDescriptorSets(point, *pipeline.layout, 0, all, nullptr);
}

void beginRendering(vk::CommandBuffer commands, const vk::RenderingAttachmentInfo& color,
                    vk::ImageView depthView, vk::Extent2D extent)
{
    const vk::RenderingAttachmentInfo depth{.imageView = depthView,
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
}

void setViewport(vk::CommandBuffer commands, vk::Extent2D extent)
{
    commands.setViewport(
        0, vk::Viewport{
               .width = float(extent.width), .height = float(extent.height), .minDepth = 0, .maxDepth = 1});
    commands.setScissor(0, vk::Rect2D{{0, 0}, extent});
}

void drawTriangles(Frame& frame, size_t object)
{
    const GpuObject& o = frame.scene.objects()[object];
    const vk::CommandBuffer commands = frame.commands;
    commands.setCullMode(o.data.flags & shared::kObjectDoubleSided ? vk::CullModeFlagBits::eNone
                                                                   : vk::CullModeFlagBits::eBack);
    commands.setFrontFace(o.mirrored ? vk::FrontFace::eClockwise : vk::FrontFace::eCounterClockwise);
    // Indexed, so that a vertex which triangles share is transformed once.
    commands.bindIndexBuffer(o.indices, 0, vk::IndexType::eUint32);
    commands.bindVertexBuffers(0, {o.vertices, frame.scene.objectTable().handle()}, {0, 0});
    commands.drawIndexed(o.indexCount, 1, 0, 0, uint32_t(object));
}

} // namespace lumel
