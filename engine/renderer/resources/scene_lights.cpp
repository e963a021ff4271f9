#include "scene_lights.h"
#include "core/error.h"
#include <algorithm>
#include <cstring>
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

void SceneLights::set(const std::vector<scene::Light>& lights, uint32_t frame)
{
    if (lights.size() > shared::kMaxLights)
        throw Error(fmt::format("the scene has {} lights, the limit is {}; remove some", lights.size(),
                                shared::kMaxLights));
    const bool recount = lights.size() != table_.size();
    table_.resize(lights.size());
    for (size_t i = 0; i < lights.size(); ++i) {
        shared::Light light = packLight(lights[i]);
        light.changed = table_[i].changed;
        if (recount || std::memcmp(&light, &table_[i], sizeof(light)) != 0) {
            light.changed = changed_ = frame;
            table_[i] = light;
        }
    }
    brightestSun_ = 0.0f;
    for (const scene::Light& light : lights)
        if (light.type == scene::LightType::directional)
            brightestSun_ = std::max(brightestSun_, light.intensity);
    updateAmbient(frame);
}

void SceneLights::setEnvironment(std::shared_ptr<const EnvironmentMap> environment, uint32_t frame)
{
    environment_ = std::move(environment);
    set_.bindEnvironment(environment_->view());
    updateAmbient(frame);
    const float intensity = std::exchange(environmentView_, {}).intensity;
    adjustEnvironment(intensity, environmentDegrees_, frame);
    touchAll(frame);
}

void SceneLights::adjustEnvironment(float intensity, float degrees, uint32_t frame)
{
    shared::EnvironmentView view{.diffuse = {},
                                 .intensity = intensity,
                                 .turn = {std::cos(glm::radians(degrees)), std::sin(glm::radians(degrees))}};
    for (size_t i = 0; i < environment_->diffuse().size(); ++i)
        view.diffuse[i] = environment_->diffuse()[i] * intensity;
    if (environment_->exists()) { // the hemisphere's irradiance over pi is linear in N.up, the third term
        view.diffuse[0] += 0.5f * (sky_ + ground_);
        view.diffuse[2] += 0.5f * (sky_ - ground_);
    }
    environmentDegrees_ = degrees;
    if (std::memcmp(&view, &environmentView_, sizeof(view)) == 0)
        return;
    environmentView_ = view;
    touchAll(frame);
}

void SceneLights::adjustAmbient(std::optional<float> ambient, uint32_t frame)
{
    ambient_ = ambient;
    updateAmbient(frame);
}

// By default a little fill where there is no environment, so that what no light reaches is dim, not black.
void SceneLights::updateAmbient(uint32_t frame)
{
    const glm::vec3 sky(ambient_ ? *ambient_ : environment_->exists() ? 0.0f : 0.04f * brightestSun_);
    if (sky == sky_)
        return;
    sky_ = sky;
    ground_ = sky_ / 3.0f;
    adjustEnvironment(environmentView_.intensity, environmentDegrees_, frame);
    touchAll(frame);
}

void SceneLights::setShadows(const std::vector<shared::Shadow>& shadows, uint32_t frame)
{
    // A light that got or lost its map is another for all that it reaches.
    const auto touchMissing = [&](const auto& from, const auto& in) {
        for (const shared::Shadow& shadow : from)
            if (shadow.light < table_.size() &&
                std::ranges::none_of(in, [&](const auto& s) { return s.light == shadow.light; }))
                touch(shadow.light, frame);
    };
    touchMissing(shadows_, shadows);
    touchMissing(shadows, shadows_);
    // So is one whose map has moved to another layer, since visibility is cached by layer.
    for (size_t i = 0; i < std::min(shadows.size(), shadows_.size()); ++i)
        if (shadows[i].light != shadows_[i].light)
            touch(shadows[i].light, frame);
    shadows_ = shadows;
}

uint32_t SceneLights::features(size_t shadowMaps) const
{
    return (environment_->exists() ? shared::kFeatureEnvironment : 0u) |
           (shadowMaps == 0 ? 0u : shared::kFeatureShadows) |
           (shadowMaps < table_.size() ? shared::kFeatureUnshadowed : 0u) |
           (table_.size() > 32 ? shared::kFeatureManyLights : 0u);
}

void SceneLights::describe(shared::View& view) const
{
    view.lightCount = uint32_t(table_.size());
    view.lightsChanged = changed_;
    view.skyRadiance = sky_;
    view.groundRadiance = ground_;
    view.environment = environmentView_;
    view.shadowCount = 0;
    std::ranges::fill(view.shadowed, 0u);
    for (const shared::Shadow& shadow : shadows_) {
        view.shadows[view.shadowCount++] = shadow;
        view.shadowed[shadow.light / 32] |= 1u << shadow.light % 32;
    }
}

} // namespace lumel
