#include "draw_pass.h"
#include "edge_pass.h"
#include "renderer/resources/culling.h"
#include "vertex_input.h"
#include <algorithm>
#include <ranges>

namespace lumel {

// The reference reads the finest level, whose samples are its filter.
static uint32_t forwardAnisotropy(const Settings& settings)
{
    return settings.shading == Shading::reference ? 1u : uint32_t(settings.forwardAnisotropy);
}

// Without a limit, every tile that is needed has light.
static uint32_t litFeatures(const Frame& frame)
{
    return frame.lumelBudget < ~0u ? shared::kFeatureWaiting : 0u;
}

static uint32_t forwardFeatures(const Frame& frame, const GpuObject& object)
{
    return frame.scene.lights().features() | surfaceFeatures(object);
}

const gpu::Pipeline& DrawPass::pipeline(const Frame& frame, const LitPool& pool, Kind kind, uint32_t features)
{
    const bool multisampling = bool(frame.targets.multisampled);
    const bool shades = kind == Kind::forward || kind == Kind::blended;
    const uint32_t filter = kind == Kind::lit ? uint32_t(frame.settings.filter) : 0u;
    const uint32_t anisotropy = shades ? forwardAnisotropy(frame.settings) : 1u;
    gpu::Pipeline& pipeline = pipelines_[{kind, multisampling, features, filter, anisotropy}];
    if (pipeline.handle.begun())
        return pipeline;
    gpu::GraphicsInfo info{
        .vertex = "surface.vert",
        .fragment = "forward.frag",
        .bindings = kMeshBindings,
        .attributes =
            meshAttributes({shared::kAttributePosition, shared::kAttributeNormal, shared::kAttributeTangent,
                            shared::kAttributeUv, shared::kAttributeMaterialUv, shared::kAttributeWorld,
                            shared::kAttributeWorldNormal}),
        .sets = {*frame.scene.frameSet().layout(), *frame.scene.materialLayout()},
        .pushBytes = sizeof(shared::ForwardPush),
        .samples = multisampling ? vk::SampleCountFlagBits::e4 : vk::SampleCountFlagBits::e1,
        .features = features,
        .filter = filter,
        .anisotropy = anisotropy,
        .blend = kind == Kind::blended};
    if (kind == Kind::lit) {
        info.vertex = "lit.vert";
        info.fragment = "draw.frag";
        info.attributes =
            meshAttributes({shared::kAttributePosition, shared::kAttributeUv, shared::kAttributeWorld});
        info.sets = {*frame.scene.frameSet().layout(), *pool.layout()};
        info.pushBytes = sizeof(shared::LitPush);
    } else if (kind == Kind::background) {
        info.vertex = "background.vert";
        info.fragment = "background.frag";
        info.bindings = {};
        info.attributes = {};
        info.sets = {*frame.scene.frameSet().layout()};
        info.pushBytes = 0;
        info.background = true;
    } else if (kind == Kind::view) {
        info.fragment = "view.frag";
        info.pushBytes = sizeof(shared::ViewPush);
    } else if (kind == Kind::pool) {
        info.bindings = {};
        info.attributes = {};
        info.vertex = "pool.vert";
        info.fragment = "pool.frag";
        info.sets = {*frame.scene.frameSet().layout(), *pool.layout()};
        info.pushBytes = sizeof(shared::PoolPush);
    }
    return pipeline = gpu::makeGraphicsPipeline(frame.device, info);
}

// Of a surface's, those that view.frag is made for: how lobes are stored.
static uint32_t viewFeatures(uint32_t surface)
{
    return surface & shared::kFeatureSecondLobe;
}

void DrawPass::prepare(const Frame& frame, const LitPool& pool, uint32_t lights)
{
    const Settings& settings = frame.settings;
    if (settings.view != View::none) {
        pipeline(frame, pool, settings.view == View::pool ? Kind::pool : Kind::view);
        for (const SurfaceKind& kind : frame.scene.surfaceKinds())
            if (settings.view != View::pool)
                pipeline(frame, pool, Kind::view, viewFeatures(kind.features));
        return;
    }
    const bool tsl = settings.shading == Shading::tsl;
    if (tsl)
        pipeline(frame, pool, Kind::lit, litFeatures(frame));
    if (tsl && settings.budgetMs > 0.0) // it limits the lumels of some frames
        pipeline(frame, pool, Kind::lit, shared::kFeatureWaiting);
    if (lights & shared::kFeatureEnvironment)
        pipeline(frame, pool, Kind::background);
    for (const SurfaceKind& kind : frame.scene.surfaceKinds())
        pipeline(frame, pool, kind.blend ? Kind::blended : Kind::forward, lights | kind.features);
}

void DrawPass::prepareFades(const Frame& frame, const LitPool& pool, uint32_t lights)
{
    for (const SurfaceKind& kind : frame.scene.surfaceKinds())
        if (frame.settings.view == View::none)
            pipeline(frame, pool, Kind::blended, lights | kind.features);
}

// Of an opaque object's pixels.
static float alphaOf(const Frame& frame, size_t object)
{
    return filtersEdges(frame.settings) ? shared::objectNumber(uint32_t(object)) : 1.0f;
}

void DrawPass::drawLit(Frame& frame, const LitPool& pool, size_t object)
{
    const vk::CommandBuffer commands = frame.commands;
    const gpu::Pipeline& lit = pipeline(frame, pool, Kind::lit, litFeatures(frame));
    bindSets(frame, vk::PipelineBindPoint::eGraphics, lit,
             {*pool.block(frame.residency.objects()[object].texture).set});
    const tsl::ObjectResidency& resident = frame.residency.objects()[object];
    const LitBlock& block = pool.block(resident.texture);
    shared::LitPush push{.draw = {.object = uint32_t(object),
                                  .opacity = alphaOf(frame, object),
                                  .level = -1.0f,
                                  .frame = frame.index},
                         .tiles = block.states.address() + block.stateOffset(resident.texture.layer),
                         .size = block.layout.size,
                         .level = frame.detail.levelOffset,
                         .finest = resident.finest,
                         .anisotropy = frame.detail.anisotropy,
                         .layer = resident.texture.layer,
                         .mips = block.layout.mips,
                         .tileOffsets = {}};
    std::copy(block.layout.tileOffsets.begin(), block.layout.tileOffsets.end(), push.tileOffsets);
    pushConstants(commands, lit, push);
    drawTriangles(frame, object);
}

void DrawPass::drawForward(Frame& frame, const LitPool& pool, size_t object, float opacity)
{
    const vk::CommandBuffer commands = frame.commands;
    const GpuObject& o = frame.scene.objects()[object];
    const bool blends = o.blend || opacity < 1.0f;
    const gpu::Pipeline& forward =
        pipeline(frame, pool, blends ? Kind::blended : Kind::forward, forwardFeatures(frame, o));
    bindSets(frame, vk::PipelineBindPoint::eGraphics, forward, {*o.material->set});
    shared::ForwardPush push{.draw = {.object = uint32_t(object),
                                      .opacity = blends ? opacity : alphaOf(frame, object),
                                      .level = frame.settings.shading == Shading::reference ? 0.0f : -1.0f,
                                      .frame = frame.index},
                             .lights = {},
                             .flags = o.data.flags,
                             .alphaCutoff = o.data.alphaCutoff,
                             .dielectric = o.data.dielectric};
    std::ranges::copy(lightsReaching(o, frame.scene.lights().table()), push.lights);
    pushConstants(commands, forward, push);
    drawTriangles(frame, object);
}

void DrawPass::drawBackground(Frame& frame, const LitPool& pool)
{
    bindSets(frame, vk::PipelineBindPoint::eGraphics, pipeline(frame, pool, Kind::background));
    setCulling(frame, vk::CullModeFlagBits::eNone, vk::FrontFace::eCounterClockwise);
    frame.commands.draw(3, 1, 0, 0);
}

void DrawPass::drawView(Frame& frame, const LitPool& pool, size_t object)
{
    const gpu::Pipeline& view =
        pipeline(frame, pool, Kind::view, viewFeatures(surfaceFeatures(frame.scene.objects()[object])));
    bindSets(frame, vk::PipelineBindPoint::eGraphics, view, {*frame.scene.objects()[object].material->set});
    pushConstants(
        frame.commands, view,
        shared::ViewPush{
            .draw = {.object = uint32_t(object), .opacity = 1.0f, .level = -1.0f, .frame = frame.index},
            .kind = uint32_t(frame.settings.view)});
    drawTriangles(frame, object);
}

void DrawPass::drawPool(Frame& frame, const LitPool& pool)
{
    const auto& blocks = pool.bookkeeping().blocks();
    std::vector<tsl::TextureId> textures;
    float tallest = 0.0f; // height by width, MIPs included
    for (size_t i = 0; i < blocks.size(); ++i)
        for (uint32_t layer = 0; pool.blocks()[i] && layer < blocks[i].textures.size(); ++layer) {
            if (blocks[i].textures[layer].owner < 0)
                continue;
            const glm::vec2 extent(pool.blocks()[i].layout.extent);
            textures.push_back({int(i), layer});
            tallest = std::max(tallest, extent.y / extent.x);
        }
    // The fewest columns whose cells leave resident for all rows.
    const glm::vec2 picture(frame.renderSize);
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
        const gpu::Pipeline& view = pipeline(frame, pool, Kind::pool);
        bindSets(frame, vk::PipelineBindPoint::eGraphics, view, {*block.set});
        const bool drawn = pool.bookkeeping().texture(textures[i]).lastUsed == frame.index;
        pushConstants(frame.commands, view,
                      shared::PoolPush{.rectangle = {corner, size},
                                       .layer = float(textures[i].layer),
                                       .shade = drawn ? 1.0f : 0.3f});
        setCulling(frame, vk::CullModeFlagBits::eNone, vk::FrontFace::eCounterClockwise);
        frame.commands.draw(6, 1, 0, 0);
    }
}

// The objects in view: what hides others is drawn before them, so that hidden pixels cost a depth test.
std::vector<size_t> DrawPass::nearestFirst(const Frame& frame)
{
    std::vector<std::pair<float, size_t>> ranking; // by the distance of their middles
    for (size_t i = 0; i < frame.inView.size(); ++i)
        if (frame.inView[i]) {
            const GpuObject& o = frame.scene.objects()[i];
            const glm::vec3 centre = o.data.worldFromObject * glm::vec4(o.bounds.centre(), 1.0f);
            ranking.emplace_back(glm::distance(centre, frame.eye), i);
        }
    std::ranges::sort(ranking);
    std::vector<size_t> objects;
    for (const auto& [distance, object] : ranking)
        objects.push_back(object);
    return objects;
}

void DrawPass::begin(Frame& frame)
{
    const vk::CommandBuffer commands = frame.commands;
    const Targets& targets = frame.targets;
    const auto discard = [&](const gpu::Image& image, gpu::Use use) {
        gpu::imageBarrier(commands, image.handle(), image.aspect(), gpu::Use::undefined, use);
    };
    discard(targets.hdr, gpu::Use::colorWrite);
    discard(targets.depth, gpu::Use::depthWrite);
    const vk::Extent2D extent{frame.renderSize.x, frame.renderSize.y}; // a part of the targets
    vk::RenderingAttachmentInfo color{.imageView = targets.hdr.view(),
                                      .imageLayout = vk::ImageLayout::eColorAttachmentOptimal,
                                      .loadOp = vk::AttachmentLoadOp::eClear,
                                      .storeOp = vk::AttachmentStoreOp::eStore};
    // The background is the ambient light at its horizon. Alpha tells that nothing is there.
    const SceneLights& lights = frame.scene.lights();
    const glm::vec3 horizon = 0.5f * (lights.skyRadiance() + lights.groundRadiance());
    color.clearValue = vk::ClearColorValue(std::array<float, 4>{horizon.r, horizon.g, horizon.b, 0.0f});
    if (targets.multisampled) {
        discard(targets.multisampled, gpu::Use::colorWrite);
        // Resolved in linear light, like the reference's samples.
        color.imageView = targets.multisampled.view();
        color.storeOp = vk::AttachmentStoreOp::eDontCare;
        color.resolveMode = vk::ResolveModeFlagBits::eAverage;
        color.resolveImageView = targets.hdr.view();
        color.resolveImageLayout = vk::ImageLayout::eColorAttachmentOptimal;
    }
    beginRendering(commands, color, targets.depth.view(), extent);
}

void DrawPass::drawObjects(Frame& frame, const LitPool& pool)
{
    std::vector<size_t> blended, fading; // fading: between lit texture and forward
    const auto& residency = frame.residency.objects();
    for (const size_t i : nearestFirst(frame)) {
        const bool lit =
            frame.settings.shading == Shading::tsl && i < residency.size() && residency[i].texture;
        if (frame.scene.objects()[i].blend) {
            blended.push_back(i);
        } else if (lit) {
            drawLit(frame, pool, i);
            if (residency[i].share < 1.0f)
                fading.push_back(i);
        } else {
            drawForward(frame, pool, i, 1.0f);
        }
    }
    if (frame.scene.lights().features() & shared::kFeatureEnvironment)
        drawBackground(frame, pool); // where no depth is
    for (const size_t object : fading)
        drawForward(frame, pool, object, 1.0f - residency[object].share);
    for (const size_t object : blended | std::views::reverse)
        drawForward(frame, pool, object, 1.0f);
}

void DrawPass::record(Frame& frame, const LitPool& pool)
{
    const PassScope scope(frame, "draw");
    begin(frame);
    if (frame.settings.view == View::none)
        drawObjects(frame, pool);
    else if (frame.settings.view == View::pool)
        drawPool(frame, pool);
    else
        for (const size_t object : nearestFirst(frame))
            drawView(frame, pool, object);
    frame.commands.endRendering();
}

} // namespace lumel
