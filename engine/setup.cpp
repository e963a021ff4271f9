#include "setup.h"
#include "core/error.h"
#include "scene/view_camera.h"
#include <charconv>
#include <fmt/format.h>

namespace lumel {

scene::Camera chooseCamera(const SceneArguments& arguments, const scene::Scene& scene)
{
    const float aspect = float(arguments.settings.size.x) / float(arguments.settings.size.y);
    if (arguments.eye || arguments.target) {
        const glm::vec3 target = arguments.target.value_or(scene.bounds.centre());
        const glm::vec3 eye =
            arguments.eye.value_or(target + glm::vec3(0.0f, 0.0f, 3.0f * scene.bounds.radius()));
        if (glm::distance(eye, target) < 1e-9f)
            throw Error("--eye and --target are the same point; move one of them");
        return scene::ViewCamera::atPoints(eye, target, arguments.fovDegrees, scene.bounds);
    }
    if (arguments.camera.empty())
        return scene.cameras.empty() ? scene::frameBounds(scene.bounds, aspect) : scene.cameras.front();
    std::string known;
    for (const auto& camera : scene.cameras) {
        if (camera.name == arguments.camera)
            return camera;
        known += " " + camera.name;
    }
    size_t index = scene.cameras.size();
    const char* end = arguments.camera.data() + arguments.camera.size();
    const auto parsed = std::from_chars(arguments.camera.data(), end, index);
    if (parsed.ec == std::errc() && parsed.ptr == end && index < scene.cameras.size())
        return scene.cameras[index];
    throw Error(fmt::format("{}: no camera '{}'; it has{}", arguments.scene.string(), arguments.camera,
                            known.empty() ? " none: leave --camera out" : known));
}

void changeScene(const SceneArguments& arguments, scene::Scene& scene)
{
    if (arguments.lights > 0)
        scene.lights = scene::lightRing(arguments.lights, scene.bounds);
    if (!arguments.lightList.empty())
        scene.lights = arguments.lightList;
    for (const auto& [name, file] : arguments.materialFiles) {
        std::string known;
        bool found = false;
        for (scene::Material& material : scene.materials) {
            known += " " + material.name;
            if (material.name == name) {
                material.bakedFile = file;
                found = true;
            }
        }
        if (!found)
            throw Error(fmt::format("{}: no material '{}'; it has{}", arguments.scene.string(), name, known));
    }
}

} // namespace lumel
