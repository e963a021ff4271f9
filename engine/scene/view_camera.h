// An interactive camera: around its target, or through the scene.
#pragma once
#include "scene.h"

namespace lumel::scene {

class ViewCamera {
public:
    // Speeds follow the scene's size and the distance to the target.
    // `moved`: the camera has no name that `--camera` takes.
    void reset(const Camera& camera, const Bounds& bounds, bool moved = false);

    const Camera& camera() const { return camera_; }
    bool moved() const { return moved_; } // since reset()
    // The camera that `--eye --target --fov` ask for; what `camera()` is as soon as it has moved.
    static Camera atPoints(glm::vec3 eye, glm::vec3 target, float fovDegrees, const Bounds& bounds);
    float fovDegrees() const { return fovDegrees_; }
    void setFovDegrees(float degrees);

    // Around the target, by parts of half a turn; the eye stays off the poles.
    void orbit(glm::vec2 halfTurns);
    // The eye looks elsewhere from where it is.
    void look(glm::vec2 halfTurns);
    // Eye and target together, in the picture's plane, by parts of its height at the target.
    void pan(glm::vec2 heights);
    // Towards the target: each step takes a tenth of the distance.
    void dolly(float steps);
    // right, up, forward in [-1, 1] of the flying speed: the distance to the target, or a fifth of the
    // scene's radius, whichever is more, a second.
    void fly(glm::vec3 direction, float seconds);
    // Looks at the middle of `bounds` from the same side, so that they fill the picture.
    void focus(const Bounds& bounds);

private:
    void set(glm::vec3 eye, glm::vec3 target);
    Camera camera_;
    Bounds bounds_;
    float fovDegrees_ = 40.0f;
    bool moved_ = false;
};

} // namespace lumel::scene
