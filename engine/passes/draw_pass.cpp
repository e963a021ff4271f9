#include "draw_pass.h"
#include <algorithm>

namespace lumel {

DrawPass::DrawPass(const gpu::Device& device, const Settings& settings, const GpuScene& scene,
                   const LitPool& pool)
{
    const bool multisampling = settings.msaa > 1 && settings.shading != Shading::reference;
    gpu::GraphicsInfo info{.vertex = "surface.vert",
                           .fragment = "draw.frag",
                           .sets = {*scene.frameLayout(), *pool.layout()},
                           .pushBytes = sizeof(shared::LitPush),
                           .samples =
                               multisampling ? vk::SampleCountFlagBits::e4 : vk::SampleCountFlagBits::e1,
                           .constant = uint32_t(settings.filter)};
    lit_ = gpu::makeGraphicsPipeline(device, info);
    info.fragment = "forward.frag";
    info.pushBytes = sizeof(shared::DrawPush);
    info.sets = {*scene.frameLayout(), *scene.materialLayout()};
    forward_ = gpu::makeGraphicsPipeline(device, info);
    info.blend = true;
    blended_ = gpu::makeGraphicsPipeline(device, info);
    if (settings.view == View::none)
        return;
    const bool showsPool = settings.view == View::pool;
    info.fragment = showsPool ? "pool.frag" : "view.frag";
    info.pushBytes = showsPool ? sizeof(shared::PoolPush) : sizeof(shared::ViewPush);
    info.blend = false;
    if (showsPool) {
        info.vertex = "pool.vert";
        info.sets = {*scene.frameLayout(), *pool.layout()};
    }
    view_ = gpu::makeGraphicsPipeline(device, info);
}

void DrawPass::drawLit(Frame& frame, const LitPool& pool, size_t object)
{
    const vk::CommandBuffer commands = frame.commands;
    bindSets(frame, vk::PipelineBindPoint::eGraphics, lit_,
             {*pool.block(frame.rooms.objects()[object].texture).set});
    const tsl::ObjectRoom& room = frame.rooms.objects()[object];
    const LitBlock& block = pool.block(room.texture);
    shared::LitPush push{
        .draw = {.object = uint32_t(object), .opacity = 1.0f, .level = -1.0f, .frame = frame.index},
        .tiles = block.states.address() + block.stateOffset(room.texture.layer),
        .size = block.layout.size,
        .level = frame.levelOffset,
        .finest = room.finest,
        .anisotropy = frame.settings.anisotropy,
        .layer = room.texture.layer,
        .mips = block.layout.mips,
        .waiting = frame.lumelBudget < ~0u ? 1u : 0u,
        .tileOffsets = {}};
    std::copy(block.layout.tileOffsets.begin(), block.layout.tileOffsets.end(), push.tileOffsets);
    pushConstants(commands, lit_, push);
    frame.scene.drawTriangles(commands, object);
}

void DrawPass::drawForward(Frame& frame, size_t object, float opacity)
{
    const vk::CommandBuffer commands = frame.commands;
    const GpuObject& o = frame.scene.objects()[object];
    const gpu::Pipeline& pipeline = o.blend || opacity < 1.0f ? blended_ : forward_;
    bindSets(frame, vk::PipelineBindPoint::eGraphics, pipeline, {*o.material->set});
    pushConstants(commands, pipeline,
                  shared::DrawPush{.object = uint32_t(object),
                                   .opacity = opacity,
                                   .level = frame.settings.shading == Shading::reference ? 0.0f : -1.0f,
                                   .frame = frame.index});
    frame.scene.drawTriangles(commands, object);
}

void DrawPass::drawView(Frame& frame, size_t object)
{
    bindSets(frame, vk::PipelineBindPoint::eGraphics, view_, {*frame.scene.objects()[object].material->set});
    pushConstants(
        frame.commands, view_,
        shared::ViewPush{
            .draw = {.object = uint32_t(object), .opacity = 1.0f, .level = -1.0f, .frame = frame.index},
            .kind = uint32_t(frame.settings.view)});
    frame.scene.drawTriangles(frame.commands, object);
}

void DrawPass::drawPool(Frame& frame, const LitPool& pool)
{
    const auto& blocks = pool.bookkeeping().blocks();
    std::vector<tsl::TextureId> textures;
    float tallest = 0.0f; // height by width, MIPs included
    for (size_t i = 0; i < blocks.size(); ++i)
        for (uint32_t layer = 0; pool.blocks()[i] && layer < blocks[i].textures.size(); ++layer) {
            const glm::vec2 extent(pool.blocks()[i].layout.extent);
            textures.push_back({int(i), layer});
            tallest = std::max(tallest, extent.y / extent.x);
        }
    // The fewest columns whose cells leave room for all rows.
    const glm::vec2 picture(frame.settings.size);
    float columns = 1.0f, rows = 1.0f;
    for (;; ++columns) {
        rows = std::ceil(float(textures.size()) / columns);
        if (rows * tallest * picture.x / columns <= picture.y)
            break;
    }
    const float cell = 2.0f / columns; // width in clip space
    constexpr float kFilled = 0.96f;   // of a cell
    for (size_t i = 0; i < textures.size(); ++i) {
        const LitBlock& block = pool.block(textures[i]);
        const glm::vec2 extent(block.layout.extent);
        const glm::vec2 row(std::fmod(float(i), columns), std::floor(float(i) / columns));
        const glm::vec2 size = kFilled * cell * glm::vec2(1.0f, extent.y / extent.x * picture.x / picture.y);
        const glm::vec2 corner = row * cell * glm::vec2(1.0f, tallest * picture.x / picture.y) - 1.0f;
        bindSets(frame, vk::PipelineBindPoint::eGraphics, view_, {*block.set});
        const bool drawn = pool.bookkeeping().texture(textures[i]).lastUsed == frame.index;
        pushConstants(frame.commands, view_,
                      shared::PoolPush{.rectangle = {corner, size},
                                       .layer = float(textures[i].layer),
                                       .shade = drawn ? 1.0f : 0.3f});
        frame.commands.setCullMode(vk::CullModeFlagBits::eNone);
        frame.commands.draw(6, 1, 0, 0);
    }
}

void DrawPass::record(Frame& frame, const LitPool& pool)
{
    const PassScope scope(frame, "draw");
    const vk::CommandBuffer commands = frame.commands;
    Targets& targets = frame.targets;
    const bool multisampling = bool(targets.multisampled);
    const vk::Extent2D extent{frame.renderSize.x, frame.renderSize.y};
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
    commands.beginRendering({.renderArea = {{0, 0}, extent},
                             .layerCount = 1,
                             .colorAttachmentCount = 1,
                             .pColorAttachments = &color,
                             .pDepthAttachment = &depth});
    setViewport(commands, extent);

    if (frame.settings.view == View::pool) {
        drawPool(frame, pool);
        commands.endRendering();
        return;
    }
    std::vector<std::pair<float, size_t>> blended; // distance, object
    std::vector<size_t> fading;                    // between lit texture and forward
    const auto& objects = frame.scene.objects();
    const auto& rooms = frame.rooms.objects();
    for (size_t i = 0; i < objects.size(); ++i) {
        if (!frame.inView[i])
            continue;
        const bool lit = frame.settings.shading == Shading::tsl && i < rooms.size() && rooms[i].texture;
        if (frame.settings.view != View::none) {
            drawView(frame, i);
        } else if (objects[i].blend) {
            const glm::vec3 centre =
                objects[i].data.worldFromObject * glm::vec4(objects[i].bounds.centre(), 1.0f);
            blended.emplace_back(glm::distance(centre, frame.eye), i);
        } else if (lit) {
            drawLit(frame, pool, i);
            if (rooms[i].share < 1.0f)
                fading.push_back(i);
        } else {
            drawForward(frame, i, 1.0f);
        }
    }
    for (const size_t object : fading)
        drawForward(frame, object, 1.0f - rooms[object].share);
    std::sort(blended.begin(), blended.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
    for (const auto& [distance, object] : blended)
        drawForward(frame, object, 1.0f);
    commands.endRendering();
}

} // namespace lumel
