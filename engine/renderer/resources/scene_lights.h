// The lights of a scene as shaders read them: punctual lights, the environment, ambient light, shadows. It
// knows since when each is as it is, so that what they reach is lit again. `frame` is the one they change in.
#pragma once
#include "environment_map.h"
#include "frame_set.h"
#include "scene/scene.h"
#include <memory>
#include <optional>

namespace lumel {

class SceneLights {
public:
    explicit SceneLights(FrameSet& set) : set_(set) {}

    // Throws Error beyond kMaxLights.
    void set(const std::vector<scene::Light>& lights, uint32_t frame);
    // Call when no frame is in flight.
    void setEnvironment(std::shared_ptr<const EnvironmentMap> environment, uint32_t frame);
    // What the environment map is multiplied by, and turned by about +Y, in degrees.
    void adjustEnvironment(float intensity, float degrees, uint32_t frame);
    // See Settings::ambient.
    void adjustAmbient(std::optional<float> ambient, uint32_t frame);
    // The lights that have shadow maps.
    void setShadows(const std::vector<shared::Shadow>& shadows, uint32_t frame);
    // What the light reaches is lit again.
    void touch(uint32_t light, uint32_t frame) { table_[light].changed = changed_ = frame; }

    std::span<const shared::Light> table() const { return table_; }
    const std::vector<shared::Shadow>& shadows() const { return shadows_; }
    glm::vec3 skyRadiance() const { return sky_; }
    glm::vec3 groundRadiance() const { return ground_; }
    // kFeature... of shaders that light by them, and by so many shadow maps.
    uint32_t features(size_t shadowMaps) const;
    uint32_t features() const { return features(shadows_.size()); }
    void writeTable() { set_.writeLights(table_); } // for the next frame
    void describe(shared::View& view) const;        // their part of it

    uint32_t changed() const { return changed_; }       // frame of the last change to any of them
    uint32_t changedAll() const { return changedAll_; } // of the last one that all objects see

private:
    void updateAmbient(uint32_t frame);
    void touchAll(uint32_t frame) { changed_ = changedAll_ = frame; }

    FrameSet& set_;
    std::vector<shared::Light> table_;
    float brightestSun_ = 0.0f; // lux
    std::shared_ptr<const EnvironmentMap> environment_;
    shared::EnvironmentView environmentView_{};
    float environmentDegrees_ = 0.0f;
    std::optional<float> ambient_;
    glm::vec3 sky_{0.0f}, ground_{0.0f};
    std::vector<shared::Shadow> shadows_;
    uint32_t changed_ = 0, changedAll_ = 0;
};

} // namespace lumel
