#include "shadow_pass.h"
#include "gpu/sampler.h"
#include "renderer/resources/culling.h"
#include "vertex_input.h"
#include <algorithm>
#include <array>

namespace lumel {
namespace {

using shared::Light;

std::vector<vk::VertexInputAttributeDescription> attributes()
{
    return meshAttributes(
        {shared::kAttributePosition, shared::kAttributeMaterialUv, shared::kAttributeWorld});
}

// Spot lights this wide see nearly a half space, of which no plane map is a picture.
constexpr float kWidestSpot = 1.4f; // radians, half angle

Bounds worldBounds(const GpuObject& object)
{
    Bounds bounds;
    for (int corner = 0; corner < 8; ++corner)
        bounds.add(object.data.worldFromObject * glm::vec4(object.bounds.corner(corner), 1.0f));
    return bounds;
}

float halfAngleOf(const Light& light)
{
    return std::acos(std::clamp(-light.coneOffset / light.coneScale, -1.0f, 1.0f));
}

float powerOf(const Light& light)
{
    return light.intensity.x + light.intensity.y + light.intensity.z;
}

bool mayHaveMap(const Light& light)
{
    const bool isSpot = light.type == shared::kLightSpot && halfAngleOf(light) <= kWidestSpot;
    return (light.type == shared::kLightDirectional || isSpot) && powerOf(light) > 0.0f;
}

// Illuminance in the scene's middle.
float strengthOf(const Light& light, const Bounds& bounds)
{
    if (light.type == shared::kLightDirectional)
        return powerOf(light);
    return powerOf(light) / std::max(glm::distance(light.position, bounds.centre()), 0.1f * bounds.radius());
}

// The strongest lights in the order of the table, so that small changes do not swap maps.
std::vector<uint32_t> chooseLights(std::span<const Light> lights, const Bounds& bounds)
{
    std::vector<std::pair<float, uint32_t>> ranking;
    for (uint32_t i = 0; i < std::min<size_t>(lights.size(), shared::kListedLights); ++i)
        if (mayHaveMap(lights[i]))
            ranking.emplace_back(-strengthOf(lights[i], bounds), i);
    std::sort(ranking.begin(), ranking.end());
    ranking.resize(std::min<size_t>(ranking.size(), shared::kMaxShadows));
    std::vector<uint32_t> chosen;
    for (const auto& [strength, light] : ranking)
        chosen.push_back(light);
    std::sort(chosen.begin(), chosen.end());
    return chosen;
}

glm::mat4 lightFromWorld(const Light& light)
{
    const glm::vec3 up = std::abs(light.direction.y) < 0.9f ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
    const glm::vec3 eye = light.type == shared::kLightDirectional ? glm::vec3(0.0f) : light.position;
    return glm::lookAt(eye, eye + light.direction, up);
}

// All of the scene, whatever the camera sees: nothing moves in the map when the camera does.
glm::mat4 clipFromWorldOf(const Light& light, const Bounds& bounds)
{
    const glm::mat4 fromWorld = lightFromWorld(light);
    Bounds seen;
    for (int corner = 0; corner < 8; ++corner)
        seen.add(fromWorld * glm::vec4(bounds.corner(corner), 1.0f));
    const float slack = 0.01f * std::max(bounds.radius(), 1e-6f);
    if (light.type == shared::kLightDirectional)
        return reversedOrthographic(seen.lower - slack, seen.upper + slack) * fromWorld;
    const float farthest = std::max(-seen.lower.z, 1e-6f);
    // A little wider than the cone, for the filter.
    return reversedPerspective(2.0f * halfAngleOf(light) + 0.03f, 1.0f, 0.005f * farthest) * fromWorld;
}

// World metres a texel: everywhere for a sun, at a distance of 1 for a spot light.
float texelOf(const glm::mat4& clipFromWorld, uint32_t size)
{
    // The lengths of the rows that give clip x and y; the greater texel counts.
    const glm::mat4 rows = glm::transpose(clipFromWorld);
    const float scale = std::min(glm::length(glm::vec3(rows[0])), glm::length(glm::vec3(rows[1])));
    return 2.0f / (scale * float(size));
}

} // namespace

gpu::ImageInfo shadowMapInfo(uint32_t size, uint32_t layers)
{
    using Usage = vk::ImageUsageFlagBits;
    return {.format = vk::Format::eD32Sfloat,
            .width = size,
            .height = size,
            .layers = layers,
            .usage = Usage::eDepthStencilAttachment | Usage::eSampled | Usage::eTransferDst,
            .arrayView = true,
            .remedy = "use a smaller --shadow-size"};
}

ShadowPass::ShadowPass(const gpu::Device& device, SceneState& scene)
    : viewLayout_(gpu::makeSetLayout(device, {vk::DescriptorType::eUniformBuffer})),
      sampler_(gpu::makeShadowSampler(device)),
      solid_(gpu::makeGraphicsPipeline(device, {.vertex = "shadow.vert",
                                                .bindings = kMeshBindings,
                                                .attributes = attributes(),
                                                .sets = {*viewLayout_},
                                                .pushBytes = sizeof(shared::ShadowPush),
                                                .color = vk::Format::eUndefined})),
      list_(device, scene.objects().size())
{
    allocate(device, scene, 1, 1);
}

void ShadowPass::allocate(const gpu::Device& device, SceneState& scene, uint32_t size, uint32_t layers)
{
    layers_.clear();
    known_.clear();
    maps_ = gpu::Image(device, shadowMapInfo(size, layers), "shadow maps");
    for (uint32_t layer = 0; layer < layers; ++layer)
        layers_.push_back(maps_.layerView(device, layer));
    device.runOnce([&](vk::CommandBuffer commands) {
        // Infinitely far: no shadow where none is rendered yet.
        gpu::imageBarrier(commands, maps_.handle(), maps_.aspect(), gpu::Use::undefined,
                          gpu::Use::transferWrite);
        commands.clearDepthStencilImage(maps_.handle(), vk::ImageLayout::eTransferDstOptimal,
                                        vk::ClearDepthStencilValue{0.0f, 0},
                                        vk::ImageSubresourceRange{maps_.aspect(), 0, 1, 0, layers});
        gpu::imageBarrier(commands, maps_.handle(), maps_.aspect(), gpu::Use::transferWrite,
                          gpu::Use::shaderSample);
    });
    scene.frameSet().bindShadows(*sampler_, maps_.view());
}

// Made when first needed.
vk::DescriptorSet ShadowPass::viewSet(const Frame& frame)
{
    vk::raii::DescriptorSet& set = viewSets_[frame.place];
    if (!*set) {
        set = gpu::makeSet(frame.device, viewLayout_);
        gpu::writeUniform(frame.device, *set, 0, frame.scene.frameSet().viewBuffer());
    }
    return *set;
}

void ShadowPass::prepare(Frame& in)
{
    SceneState& scene = in.scene;
    const Settings& settings = in.settings;
    const uint32_t frame = in.index;
    uint32_t moved = 0;
    for (const GpuObject& object : scene.objects()) {
        if (!object.casts)
            continue;
        moved = std::max(moved, object.moved);
        const Bounds bounds = worldBounds(object);
        bounds_.add(bounds.lower);
        bounds_.add(bounds.upper);
    }
    std::vector<uint32_t> chosen;
    if (settings.shadows && !bounds_.empty())
        chosen = chooseLights(scene.lights().table(), bounds_);
    if (!chosen.empty() && !holds(settings.shadowSize, uint32_t(chosen.size()))) {
        in.ring.waitForAll();
        allocate(in.device, scene, settings.shadowSize, uint32_t(chosen.size()));
    }
    std::vector<shared::Shadow> shadows;
    known_.resize(chosen.size());
    for (size_t i = 0; i < chosen.size(); ++i) {
        const Light& light = scene.lights().table()[chosen[i]];
        const glm::mat4 clip = clipFromWorldOf(light, bounds_);
        Map& map = known_[i];
        if (map.light != chosen[i] || map.clipFromWorld != clip || moved > map.rendered || !map.rendered) {
            map = {.light = chosen[i], .clipFromWorld = clip, .rendered = frame, .current = false};
            scene.lights().touch(map.light, frame);
        }
        const glm::mat4 mapFromClip(0.5f, 0, 0, 0, 0, 0.5f, 0, 0, 0, 0, 1, 0, 0.5f, 0.5f, 0, 1);
        shadows.push_back({.mapFromWorld = mapFromClip * clip,
                           .light = chosen[i],
                           .texel = texelOf(clip, settings.shadowSize)});
    }
    scene.lights().setShadows(shadows, frame);
}

size_t ShadowPass::countMaps(const SceneState& scene, const Settings& settings)
{
    if (!settings.shadows || std::ranges::none_of(scene.objects(), &GpuObject::casts))
        return 0;
    const std::span lights = scene.lights().table();
    const auto listed = lights.first(std::min<size_t>(lights.size(), shared::kListedLights));
    return std::min<size_t>(size_t(std::ranges::count_if(listed, mayHaveMap)), shared::kMaxShadows);
}

void ShadowPass::preparePipelines(const Frame& frame)
{
    for (const SurfaceKind& kind : frame.scene.surfaceKinds())
        if (kind.mask)
            maskPipeline(frame, kind.features & shared::kFeatureColoured);
}

const gpu::Pipeline& ShadowPass::maskPipeline(const Frame& frame, bool coloured)
{
    // Vertex colours have a say in what alpha cuts out; what lights the object has none.
    const uint32_t features = coloured ? shared::kFeatureColoured : 0u;
    gpu::Pipeline& masked = masked_[features];
    if (!masked.handle.begun())
        masked =
            gpu::makeGraphicsPipeline(frame.device, {.vertex = "shadow.vert",
                                                     .fragment = "shadow.frag",
                                                     .bindings = kMeshBindings,
                                                     .attributes = attributes(),
                                                     .sets = {*viewLayout_, *frame.scene.materialLayout()},
                                                     .pushBytes = sizeof(shared::ShadowPush),
                                                     .color = vk::Format::eUndefined,
                                                     .features = features});
    return masked;
}

void ShadowPass::drawMasked(Frame& frame, const Map& map, size_t object)
{
    const GpuObject& o = frame.scene.objects()[object];
    const gpu::Pipeline& pipeline = maskPipeline(frame, o.coloured);
    const std::array sets{viewSet(frame), *o.material->set};
    bindAll(frame, vk::PipelineBindPoint::eGraphics, pipeline, sets);
    pushConstants(frame.commands, pipeline,
                  shared::ShadowPush{.clipFromWorld = map.clipFromWorld, .object = uint32_t(object)});
    drawTriangles(frame, object);
}

void ShadowPass::drawMap(Frame& frame, const Map& map, vk::ImageView layer,
                         std::span<const LightSet> reaching)
{
    const auto& objects = frame.scene.objects();
    const std::vector<uint8_t> inMap = objectsInView(objects, map.clipFromWorld);
    std::vector<uint32_t> solid, masked;
    for (size_t i = 0; i < inMap.size(); ++i)
        if (inMap[i] && objects[i].casts && contains(reaching[i], map.light))
            (objects[i].data.flags & shared::kObjectMask ? masked : solid).push_back(uint32_t(i));
    list_.write(frame, std::move(solid));
    const vk::RenderingAttachmentInfo depth{.imageView = layer,
                                            .imageLayout = vk::ImageLayout::eDepthAttachmentOptimal,
                                            .loadOp = vk::AttachmentLoadOp::eClear,
                                            .storeOp = vk::AttachmentStoreOp::eStore,
                                            .clearValue = vk::ClearDepthStencilValue{0.0f, 0}};
    frame.commands.beginRendering(
        {.renderArea = {{0, 0}, maps_.extent()}, .layerCount = 1, .pDepthAttachment = &depth});
    setViewport(frame.commands, maps_.extent());
    const std::array sets{viewSet(frame)};
    bindAll(frame, vk::PipelineBindPoint::eGraphics, solid_, sets);
    pushConstants(frame.commands, solid_,
                  shared::ShadowPush{.clipFromWorld = map.clipFromWorld, .object = 0});
    list_.draw(frame);
    for (const uint32_t object : masked)
        drawMasked(frame, map, object);
    frame.commands.endRendering();
}

void ShadowPass::record(Frame& frame)
{
    if (std::ranges::all_of(known_, [](const Map& map) { return map.current; }))
        return;
    const PassScope scope(frame, "shadow");
    const vk::CommandBuffer commands = frame.commands;
    gpu::imageBarrier(commands, maps_.handle(), maps_.aspect(), gpu::Use::shaderSample, gpu::Use::depthWrite);
    std::vector<LightSet> reaching; // by object
    for (const GpuObject& object : frame.scene.objects())
        reaching.push_back(lightsReaching(object, frame.scene.lights().table()));
    for (size_t i = 0; i < known_.size(); ++i) {
        Map& map = known_[i];
        if (std::exchange(map.current, true))
            continue;
        drawMap(frame, map, *layers_[i], reaching);
    }
    gpu::imageBarrier(commands, maps_.handle(), maps_.aspect(), gpu::Use::depthWrite, gpu::Use::shaderSample);
}

} // namespace lumel
