#include "frame_context.h"
#include <algorithm>
#include <utility>

namespace lumel {

void bindAll(Frame& frame, vk::PipelineBindPoint point, const gpu::Pipeline& pipeline,
             std::span<const vk::DescriptorSet> sets)
{
    BoundState::Point& bound =
        point == vk::PipelineBindPoint::eGraphics ? frame.bound.graphics : frame.bound.compute;
    const bool isNew = bound.pipeline != *pipeline.handle; // its layout may disturb what is bound
    if (isNew)
        frame.commands.bindPipeline(point, *pipeline.handle);
    bound.pipeline = *pipeline.handle;
    for (uint32_t i = 0; i < sets.size(); ++i)
        if (std::exchange(bound.sets[i], sets[i]) != sets[i] || isNew)
            frame.commands.bindDescriptorSets(point, *pipeline.layout, i, sets[i], nullptr);
}

void bindSets(Frame& frame, vk::PipelineBindPoint point, const gpu::Pipeline& pipeline,
              std::initializer_list<vk::DescriptorSet> sets)
{
    std::array<vk::DescriptorSet, std::tuple_size_v<decltype(BoundState::Point::sets)>> all{
        frame.scene.frameSet().handle()};
    std::ranges::copy(sets, all.begin() + 1);
    bindAll(frame, point, pipeline, {all.data(), sets.size() + 1});
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

void setCulling(Frame& frame, vk::CullModeFlags mode, vk::FrontFace front)
{
    if (std::exchange(frame.bound.cullMode, mode) != mode)
        frame.commands.setCullMode(mode);
    if (std::exchange(frame.bound.frontFace, front) != front)
        frame.commands.setFrontFace(front);
}

static bool isDoubleSided(const GpuObject& object)
{
    return (object.data.flags & shared::kObjectDoubleSided) != 0;
}

bool drawAlike(const GpuObject& a, const GpuObject& b)
{
    return a.vertices == b.vertices && a.indices == b.indices && a.mirrored == b.mirrored &&
           isDoubleSided(a) == isDoubleSided(b);
}

void bindMesh(Frame& frame, const GpuObject& object, uint32_t firstVertex)
{
    setCulling(frame, isDoubleSided(object) ? vk::CullModeFlagBits::eNone : vk::CullModeFlagBits::eBack,
               object.mirrored ? vk::FrontFace::eClockwise : vk::FrontFace::eCounterClockwise);
    if (std::exchange(frame.bound.indices, object.indices) != object.indices)
        frame.commands.bindIndexBuffer(object.indices, 0, vk::IndexType::eUint32);
    const bool moves = std::exchange(frame.bound.firstVertex, firstVertex) != firstVertex;
    if (std::exchange(frame.bound.vertices, object.vertices) != object.vertices || moves)
        frame.commands.bindVertexBuffers(0, {object.vertices, frame.scene.objectTable().handle()},
                                         {firstVertex * sizeof(shared::Vertex), 0});
}

void drawTriangles(Frame& frame, size_t object)
{
    const GpuObject& o = frame.scene.objects()[object];
    // From its first vertex on: shaders look up colours by gl_VertexIndex.
    bindMesh(frame, o, o.firstVertex);
    // Indexed, so that a vertex which triangles share is transformed once.
    frame.commands.drawIndexed(o.indexCount, 1, o.firstIndex, 0, uint32_t(object));
}

} // namespace lumel
