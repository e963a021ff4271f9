#include "floor_pass.h"
#include "draw_pass.h"
#include "feedback_pass.h"
#include "gpu/sampler.h"
#include "shared/limits.h"
#include "vertex_input.h"
#include <glm/gtc/packing.hpp>

namespace lumel {
namespace {

constexpr uint32_t kSide = shared::kFloorSide;
using Words = std::array<glm::uvec4, shared::kFloorSurfaceLayers>;

// A lumel of a unit sphere of rough plastic, as floor_light.comp unpacks it.
Words surfaceAt(glm::vec2 uv)
{
    const float turn = 2.0f * shared::kPi * uv.x, tilt = shared::kPi * uv.y;
    const glm::vec3 n(std::sin(tilt) * std::cos(turn), std::cos(tilt), std::sin(tilt) * std::sin(turn));
    const glm::vec4 tangent(-std::sin(turn), 0.0f, std::cos(turn), 1.0f);
    const glm::vec3 covariance(0.02f, 0.001f, 0.03f), specular(0.05f), diffuse(0.5f, 0.4f, 0.3f);
    const auto half = [](float a, float b) { return glm::packHalf2x16({a, b}); };
    return {glm::uvec4(glm::floatBitsToUint(n), glm::packSnorm4x8(tangent)),
            glm::uvec4(half(n.x, n.y), half(n.z, covariance.x), half(covariance.y, covariance.z),
                       half(0.1f, -0.05f)),
            glm::uvec4(half(specular.r, specular.g), half(specular.b, diffuse.r), half(diffuse.g, diffuse.b),
                       glm::packUnorm4x8(glm::vec4(0.04f, 0.04f, 0.04f, 0.025f)))};
}

gpu::Image makeImage(const gpu::Device& device, glm::uvec2 size, uint32_t layers, vk::Format format,
                     vk::ImageUsageFlags usage)
{
    return {device,
            {.format = format,
             .width = size.x,
             .height = size.y,
             .layers = layers,
             .usage = usage,
             .remedy = "leave out --floors"},
            "floor"};
}

gpu::GraphicsInfo meshPipeline(const Settings& settings, const char* vertex, const char* fragment,
                               std::initializer_list<uint32_t> attributes)
{
    return {.vertex = vertex,
            .fragment = fragment,
            .bindings = kMeshBindings,
            .attributes = meshAttributes(attributes),
            .samples = settings.msaa > 1 ? vk::SampleCountFlagBits::e4 : vk::SampleCountFlagBits::e1};
}

gpu::Pipeline makeDraw(const gpu::Device& device, const SceneState& scene, const Settings& settings,
                       const gpu::SetLayout& layout, uint32_t lookups)
{
    gpu::GraphicsInfo info =
        meshPipeline(settings, "lit.vert", "floor_draw.frag",
                     {shared::kAttributePosition, shared::kAttributeUv, shared::kAttributeWorld});
    info.sets = {*scene.frameSet().layout(), *layout};
    info.pushBytes = sizeof(shared::FloorPush);
    info.filter = lookups;
    return gpu::makeGraphicsPipeline(device, info);
}

gpu::Pipeline makeForward(const gpu::Device& device, const SceneState& scene, const Settings& settings)
{
    gpu::GraphicsInfo info =
        meshPipeline(settings, "surface.vert", "floor_forward.frag",
                     {shared::kAttributePosition, shared::kAttributeNormal, shared::kAttributeTangent,
                      shared::kAttributeUv, shared::kAttributeMaterialUv, shared::kAttributeWorld,
                      shared::kAttributeWorldNormal});
    info.sets = {*scene.frameSet().layout(), *scene.materialLayout()};
    info.pushBytes = sizeof(shared::DrawPush);
    return gpu::makeGraphicsPipeline(device, info);
}

gpu::Pipeline makeFeedback(const gpu::Device& device, const SceneState& scene)
{
    gpu::GraphicsInfo info =
        meshPipeline({}, "feedback.vert", "feedback.frag",
                     {shared::kAttributePosition, shared::kAttributeUv, shared::kAttributeWorld});
    info.sets = {*scene.frameSet().layout()};
    info.pushBytes = sizeof(shared::FeedbackPush);
    info.color = vk::Format::eR32G32B32A32Uint;
    info.samples = vk::SampleCountFlagBits::e1;
    return gpu::makeGraphicsPipeline(device, info);
}

glm::uvec2 samplesOf(glm::uvec2 pixels)
{
    return (pixels + FeedbackPass::kSparse - 1u) / FeedbackPass::kSparse;
}

using Usage = vk::ImageUsageFlagBits;

} // namespace

FloorPass::FloorPass(const gpu::Device& device, const SceneState& scene, const Settings& settings)
    : targets_(device, settings), seen_(makeImage(device, samplesOf(settings.size), 1,
                                                  vk::Format::eR32G32B32A32Uint, Usage::eColorAttachment)),
      seenDepth_(makeImage(device, samplesOf(settings.size), 1, vk::Format::eD32Sfloat,
                           Usage::eDepthStencilAttachment)),
      surfaces_(makeImage(device, glm::uvec2(kSide), shared::kFloorSurfaceLayers,
                          vk::Format::eR32G32B32A32Uint, Usage::eSampled | Usage::eTransferDst)),
      lit_(makeImage(device, glm::uvec2(kSide), 2, vk::Format::eR16G16B16A16Sfloat,
                     Usage::eSampled | Usage::eStorage)),
      linear_(gpu::makeSampler(device,
                               {.u = vk::SamplerAddressMode::eRepeat, .v = vk::SamplerAddressMode::eRepeat})),
      nearest_(gpu::makeSampler(device, {.filter = vk::Filter::eNearest})),
      layout_(gpu::makeSetLayout(device, {vk::DescriptorType::eCombinedImageSampler,
                                          vk::DescriptorType::eCombinedImageSampler,
                                          vk::DescriptorType::eStorageImage})),
      set_(gpu::makeSet(device, layout_)),
      light_(gpu::makeComputePipeline(device, "floor_light.comp", {*scene.frameSet().layout(), *layout_},
                                      sizeof(shared::FloorPush))),
      lower_(gpu::makeComputePipeline(device, "floor_lower.comp", {*scene.frameSet().layout(), *layout_},
                                      sizeof(shared::FloorPush))),
      feedback_(makeFeedback(device, scene)),
      bilinear_(makeDraw(device, scene, settings, layout_, shared::kFloorBilinear)),
      bicubic_(makeDraw(device, scene, settings, layout_, shared::kFloorBicubic)),
      twoLevels_(makeDraw(device, scene, settings, layout_, shared::kFloorTwoLevels)),
      forward_(makeForward(device, scene, settings))
{
    uploadSurfaces(device);
    gpu::writeSampled(device, *set_, 0, *linear_, lit_.view(), vk::ImageLayout::eGeneral);
    gpu::writeSampled(device, *set_, 1, *nearest_, surfaces_.view());
    gpu::writeStorage(device, *set_, 2, lit_.view());
}

void FloorPass::uploadSurfaces(const gpu::Device& device)
{
    constexpr size_t kLumels = size_t(kSide) * kSide;
    const gpu::Buffer staging(device, kLumels * sizeof(Words), gpu::Buffer::MemoryUsage::staging,
                              "floor (staging)");
    auto* layers = staging.mapped<glm::uvec4>();
    for (uint32_t y = 0; y < kSide; ++y)
        for (uint32_t x = 0; x < kSide; ++x) {
            const Words words = surfaceAt((glm::vec2(x, y) + 0.5f) / float(kSide));
            for (size_t layer = 0; layer < words.size(); ++layer)
                layers[layer * kLumels + y * kSide + x] = words[layer];
        }
    const vk::BufferImageCopy copy{
        .imageSubresource = {vk::ImageAspectFlagBits::eColor, 0, 0, shared::kFloorSurfaceLayers},
        .imageExtent = {kSide, kSide, 1}};
    device.runOnce([&](vk::CommandBuffer commands) {
        gpu::recordUpload(commands, staging, surfaces_, {copy});
        gpu::imageBarrier(commands, lit_.handle(), lit_.aspect(), gpu::Use::undefined, gpu::Use::general);
    });
}

void FloorPass::record(Frame& frame, const LitPool& pool, size_t lumelsLit, size_t lumelsDerived)
{
    drawn_ = frame.renderSize;
    lumelsLit_ = uint32_t(std::min(lumelsLit, size_t(kSide) * kSide));
    lumelsDerived_ = uint32_t(std::min(lumelsDerived, size_t(kSide) * kSide / 4));
    if (frame.settings.shading == Shading::forward) {
        const PassScope scope(frame, "forward");
        recordForward(frame);
    } else {
        if (lumelsLit_ > 0)
            recordLight(frame);
        if (lumelsDerived_ > 0)
            recordLower(frame);
        recordFeedback(frame);
        {
            const PassScope scope(frame, "bilinear");
            recordDraw(frame, pool, bilinear_);
        }
        {
            const PassScope scope(frame, "bicubic");
            recordDraw(frame, pool, bicubic_);
        }
        const PassScope scope(frame, "bicubic_two_levels");
        recordDraw(frame, pool, twoLevels_);
    }
    gpu::imageBarrier(frame.commands, targets_.hdr.handle(), targets_.hdr.aspect(), gpu::Use::colorWrite,
                      gpu::Use::transferRead); // by read()
}

void FloorPass::recordLight(Frame& frame)
{
    const PassScope scope(frame, "light");
    bindSets(frame, vk::PipelineBindPoint::eCompute, light_, {*set_});
    pushConstants(frame.commands, light_, shared::FloorPush{.size = {}, .lumels = lumelsLit_});
    dispatchList(frame.commands, lumelsLit_);
    gpu::memoryBarrier(frame.commands, gpu::Use::computeWrite, gpu::Use::general);
}

void FloorPass::recordLower(Frame& frame)
{
    const PassScope scope(frame, "lower");
    bindSets(frame, vk::PipelineBindPoint::eCompute, lower_, {*set_});
    pushConstants(frame.commands, lower_, shared::FloorPush{.size = {}, .lumels = lumelsDerived_});
    dispatchList(frame.commands, lumelsDerived_);
    gpu::memoryBarrier(frame.commands, gpu::Use::computeWrite, gpu::Use::general);
}

void FloorPass::recordFeedback(Frame& frame)
{
    const PassScope scope(frame, "feedback");
    const glm::uvec2 samples = samplesOf(frame.renderSize);
    gpu::imageBarrier(frame.commands, seen_.handle(), seen_.aspect(), gpu::Use::undefined,
                      gpu::Use::colorWrite);
    gpu::imageBarrier(frame.commands, seenDepth_.handle(), seenDepth_.aspect(), gpu::Use::undefined,
                      gpu::Use::depthWrite);
    beginRendering(frame.commands,
                   {.imageView = seen_.view(),
                    .imageLayout = vk::ImageLayout::eColorAttachmentOptimal,
                    .loadOp = vk::AttachmentLoadOp::eClear,
                    .storeOp = vk::AttachmentStoreOp::eStore},
                   seenDepth_.view(), {samples.x, samples.y});
    bindSets(frame, vk::PipelineBindPoint::eGraphics, feedback_);
    shared::FeedbackPush push{};
    push.divisor = float(FeedbackPass::kSparse);
    pushConstants(frame.commands, feedback_, push);
    for (const size_t object : DrawPass::nearestFirst(frame))
        drawTriangles(frame, object);
    frame.commands.endRendering();
}

void FloorPass::recordDraw(Frame& frame, const LitPool& pool, const gpu::Pipeline& pipeline)
{
    constexpr glm::uvec2 kWithoutTexture(64); // shaded forward: mostly small
    DrawPass::begin(frame);
    bindSets(frame, vk::PipelineBindPoint::eGraphics, pipeline, {*set_});
    const auto& residency = frame.residency.objects();
    for (const size_t object : DrawPass::nearestFirst(frame)) {
        const bool lit = object < residency.size() && residency[object].texture;
        pushConstants(frame.commands, pipeline,
                      shared::FloorPush{.size = lit ? pool.block(residency[object].texture).layout.size
                                                    : kWithoutTexture,
                                        .lumels = 0});
        drawTriangles(frame, object);
    }
    frame.commands.endRendering();
}

void FloorPass::recordForward(Frame& frame)
{
    DrawPass::begin(frame);
    for (const size_t object : DrawPass::nearestFirst(frame)) {
        bindSets(frame, vk::PipelineBindPoint::eGraphics, forward_,
                 {*frame.scene.objects()[object].material->set});
        pushConstants(
            frame.commands, forward_,
            shared::DrawPush{.object = uint32_t(object), .opacity = 1.0f, .level = -1.0f, .frame = 0});
        drawTriangles(frame, object);
    }
    frame.commands.endRendering();
}

FloorStats FloorPass::read(const gpu::Device& device, const gpu::Timer& timer) const
{
    FloorStats stats;
    const auto texels =
        gpu::readBack(device, targets_.hdr, 8, gpu::masksOf(gpu::Use::transferRead).layout); // RGBA16F
    const auto covered = [&](glm::uvec2 p) {
        const std::byte* alpha = texels.data() + 8 * (size_t(p.y) * targets_.hdr.info().width + p.x) + 6;
        return alpha[0] != std::byte(0) || alpha[1] != std::byte(0);
    };
    for (uint32_t y = 0; y < drawn_.y; ++y)
        for (uint32_t x = 0; x < drawn_.x; ++x)
            stats.pixels += covered({x, y}) ? 1 : 0;
    for (const auto& [name, ms] : timer.results()) {
        const size_t units = name == "light" ? lumelsLit_ : name == "lower" ? lumelsDerived_ : stats.pixels;
        if (units > 0)
            stats.nanoseconds[name] = 1e6 * ms / double(units);
    }
    return stats;
}

} // namespace lumel
