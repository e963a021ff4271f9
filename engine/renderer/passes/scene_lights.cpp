// GpuScene's lights, their shadows and the environment.
#include "core/error.h"
#include "gpu_scene.h"
#include "scene/environment.h"
#include "shared/shading.h"
#include "upload.h"
#include <fmt/format.h>

namespace lumel {
namespace {

shared::Light packLight(const scene::Light& light)
{
    shared::Light packed{};
    packed.type = uint32_t(light.type);
    packed.position = light.position;
    packed.direction = light.direction;
    packed.inverseRange = light.range > 0.0f ? 1.0f / light.range : 0.0f;
    packed.intensity = light.colour * light.intensity;
    // KHR_lights_punctual, "Inner and Outer Cone Angles": the reference's scale and offset.
    const float outer = std::cos(light.outerCone), inner = std::cos(light.innerCone);
    packed.coneScale = 1.0f / std::max(0.001f, inner - outer);
    packed.coneOffset = -outer * packed.coneScale;
    return packed;
}

} // namespace

void GpuScene::touchAll(uint32_t frame)
{
    changed_ = frame;
    for (GpuObject& object : objects_)
        object.data.changed = frame;
}

void GpuScene::setEnvironment(const gpu::Device& device,
                              std::shared_ptr<const scene::Environment> environment, uint32_t frame)
{
    environment_ = std::move(environment);
    const std::vector<Image> black = {Image(1, 1, 3)};
    environmentMap_ = uploadChain(device, environment_ ? environment_->levels : black, "environment");
    gpu::writeSampled(device, *frameSet_, 2, *samplers_.back(), environmentMap_.view()); // clamped
    updateAmbient(frame);
    const float intensity = std::exchange(environmentView_, {}).intensity;
    adjustEnvironment(intensity, environmentDegrees_, frame);
    touchAll(frame);
}

void GpuScene::adjustEnvironment(float intensity, float degrees, uint32_t frame)
{
    shared::EnvironmentView view{.diffuse = {},
                                 .intensity = intensity,
                                 .turn = {std::cos(glm::radians(degrees)), std::sin(glm::radians(degrees))}};
    for (size_t i = 0; environment_ && i < environment_->diffuse.size(); ++i)
        view.diffuse[i] = environment_->diffuse[i] * intensity;
    if (environment_) { // the hemisphere's irradiance over pi is linear in N.up, which is the third term
        view.diffuse[0] += 0.5f * (sky_ + ground_);
        view.diffuse[2] += 0.5f * (sky_ - ground_);
    }
    environmentDegrees_ = degrees;
    if (std::memcmp(&view, &environmentView_, sizeof(view)) == 0)
        return;
    environmentView_ = view;
    touchAll(frame);
}

void GpuScene::bindShadows(const gpu::Device& device, vk::Sampler sampler, vk::ImageView maps)
{
    gpu::writeSampled(device, *frameSet_, 3, sampler, maps);
}

void GpuScene::setShadows(const std::vector<shared::Shadow>& shadows, uint32_t frame)
{
    // A light that got or lost its map is another for all that it reaches.
    const auto touchMissing = [&](const auto& from, const auto& in) {
        for (const shared::Shadow& shadow : from)
            if (shadow.light < lightCount_ &&
                std::ranges::none_of(in, [&](const auto& s) { return s.light == shadow.light; }))
                touchLight(shadow.light, frame);
    };
    touchMissing(shadows_, shadows);
    touchMissing(shadows, shadows_);
    shadows_ = shadows;
}

void GpuScene::adjustAmbient(std::optional<float> ambient, uint32_t frame)
{
    ambient_ = ambient;
    updateAmbient(frame);
}

// By default a little fill where there is no environment, so that what no light reaches is dim, not black.
void GpuScene::updateAmbient(uint32_t frame)
{
    const glm::vec3 sky(ambient_ ? *ambient_ : environment_ ? 0.0f : 0.04f * brightestSun_);
    if (sky == sky_)
        return;
    sky_ = sky;
    ground_ = sky_ / 3.0f;
    adjustEnvironment(environmentView_.intensity, environmentDegrees_, frame);
    touchAll(frame);
}

void GpuScene::setLights(const std::vector<scene::Light>& lights, uint32_t frame)
{
    if (lights.size() > shared::kMaxLights)
        throw Error(fmt::format("the scene has {} lights, the limit is {}; remove some", lights.size(),
                                shared::kMaxLights));
    auto* table = lights_.mapped<shared::Light>();
    const bool recount = lights.size() != lightCount_;
    for (size_t i = 0; i < lights.size(); ++i) {
        shared::Light light = packLight(lights[i]);
        light.changed = table[i].changed;
        if (recount || std::memcmp(&light, &table[i], sizeof(light)) != 0) {
            light.changed = changed_ = frame;
            table[i] = light;
        }
    }
    lightCount_ = uint32_t(lights.size());
    brightestSun_ = 0.0f;
    for (const scene::Light& light : lights)
        if (light.type == scene::LightType::directional)
            brightestSun_ = std::max(brightestSun_, light.intensity);
    updateAmbient(frame);
}

std::array<uint32_t, shared::kListedLights / 32> GpuScene::lightsReaching(size_t object) const
{
    const GpuObject& o = objects_[object];
    const glm::mat4& m = o.data.worldFromObject;
    const glm::vec3 centre = m * glm::vec4(o.bounds.centre(), 1.0f);
    float radius = 0.0f; // to the farthest corner of the box
    for (int corner = 0; corner < 8; ++corner) {
        radius = std::max(radius, glm::length(glm::mat3(m) * (o.bounds.corner(corner) - o.bounds.centre())));
    }
    const auto* lights = lights_.mapped<const shared::Light>();
    std::array<uint32_t, shared::kListedLights / 32> listed{};
    for (uint32_t i = 0; i < std::min(lightCount_, shared::kListedLights); ++i)
        if (shared::lightReaches(lights[i], centre, radius))
            listed[i / 32] |= 1u << i % 32;
    return listed;
}

bool GpuScene::changedIn(size_t object, uint32_t frame) const
{
    if (changed_ < frame)
        return false; // nothing has
    if (objects_[object].data.changed >= frame)
        return true;
    const auto reaching = lightsReaching(object);
    const auto* lights = lights_.mapped<const shared::Light>();
    for (uint32_t i = 0; i < lightCount_; ++i)
        if (lights[i].changed >= frame && (i >= shared::kListedLights || (reaching[i / 32] >> i % 32 & 1u)))
            return true;
    return false;
}

} // namespace lumel
