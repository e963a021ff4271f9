// A path through a scene: where the camera, the lights and the objects are in each frame.
#pragma once
#include "renderer/frame.h"
#include "scene/camera_path.h"
#include <array>
#include <optional>

namespace lumel {

inline constexpr std::array kPathNames{"still", "orbit", "dolly", "pan", "animation"}; // scene::Path

struct PathOptions {
    scene::Path path = scene::Path::still;
    std::optional<double> step;    // degrees or percent per frame; none = the path's default
    std::optional<double> seconds; // of the scene's animation in frame 0; none = nothing moves but the camera
    double timeStep = 1.0 / 30.0;  // seconds per frame

    double stepOrDefault() const { return step.value_or(scene::defaultStep(path)); }
};

class Playback {
public:
    // `start`: a camera of the scene or any other. Throws Error when the path is the camera's animation and
    // it has none.
    Playback(const scene::Scene& scene, const scene::Camera& start, const PathOptions& options);

    // Frames may be negative: what comes before the path's start.
    scene::Camera camera(int frame) const;
    // Puts the lights and the objects that move where they belong in this frame. The renderer's objects are
    // those of the scene.
    void apply(Renderer& renderer, int frame) const;
    // The same for any time of the animation.
    void pose(Renderer& renderer, double seconds) const;
    void setLights(std::vector<scene::Light> lights) { lights_ = std::move(lights); }

private:
    double secondsOf(int frame) const;
    scene::Pose poseOf(int frame) const;

    scene::Animation animation_;
    scene::Camera start_;
    PathOptions options_;
    std::vector<scene::Light> lights_;
    struct MovingObject {
        size_t object;
        int node;
        glm::mat4 nodeFromObject;
    };
    std::vector<MovingObject> movingObjects_;
    std::vector<scene::Skin> skins_;
    std::vector<scene::DeformedMesh> deformed_;
    bool plays_;
};

} // namespace lumel
