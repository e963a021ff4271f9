#include "camera_path.h"
#include <cmath>

namespace lumel::scene {

Camera cameraOnPath(const Camera& start, Path path, double step, int index)
{
    Camera camera = start;
    const glm::vec3 fromTarget = start.eye - start.target;
    if (index == 0)
        return camera;
    if (path == Path::orbit) {
        // Reduced in double: after many frames a float's angle would be off by more than a step.
        const double degrees = std::fmod(step * index, 360.0);
        const glm::quat turn = glm::angleAxis(float(glm::radians(degrees)), glm::vec3(0, 1, 0));
        camera.eye = start.target + turn * fromTarget;
        camera.up = turn * start.up;
    }
    if (path == Path::dolly) {
        // Long dollies end where floats still tell the eye from its target.
        const auto share = float(std::clamp(std::pow(1.0 - step / 100.0, index), 1e-4, 1e6));
        camera.eye = start.target + share * fromTarget;
        // What the start camera did not clip must not be clipped closer up.
        camera.nearMetres = start.nearMetres * std::min(share, 1.0f);
    }
    if (path == Path::pan) {
        const glm::vec3 right = glm::normalize(glm::cross(-fromTarget, start.up));
        const glm::vec3 way = float(step / 100.0 * index) * glm::length(fromTarget) * right;
        camera.eye += way;
        camera.target += way;
    }
    return camera;
}

double defaultStep(Path path)
{
    switch (path) {
    case Path::orbit:
        return 0.5; // degrees
    case Path::dolly:
        return 1.0; // percent
    case Path::pan:
        return 0.1; // percent
    default:
        return 0.0;
    }
}

} // namespace lumel::scene
