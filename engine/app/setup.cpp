#include "setup.h"
#include "core/error.h"
#include "renderer/demands.h"
#include "renderer/setting_text.h"
#include "scene/environment.h"
#include "scene/view_camera.h"
#include "scene/visibility.h"
#include <charconv>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

namespace lumel {
namespace {

std::string text(double number)
{
    return fmt::format("{:g}", number);
}

// Without options.
ChosenCamera defaultCamera(const SceneArguments& arguments, const scene::Scene& scene, float aspect)
{
    if (!scene.cameras.empty()) {
        const scene::Camera& first = scene.cameras.front();
        if (scene::seesAnything(scene, first, aspect))
            return {first};
        spdlog::info("{}: its camera '{}' sees nothing; the scene is framed instead (--camera 0 keeps it)",
                     arguments.scene.string(), first.name);
    }
    return {scene::frameBounds(scene.bounds, aspect), false};
}

} // namespace

gpu::DeviceOptions deviceOptions(const SceneArguments& arguments)
{
    gpu::DeviceOptions options = forRendering(arguments.device);
    options.keepPipelines = arguments.useCache;
    return options;
}

ChosenCamera chooseCamera(const SceneArguments& arguments, const scene::Scene& scene)
{
    const float aspect = float(arguments.settings.size.x) / float(arguments.settings.size.y);
    if (arguments.eye || arguments.target) {
        const glm::vec3 target = arguments.target.value_or(scene.bounds.centre());
        const glm::vec3 eye =
            arguments.eye.value_or(target + glm::vec3(0.0f, 0.0f, 3.0f * scene.bounds.radius()));
        if (glm::distance(eye, target) < 1e-9f)
            throw Error("--eye and --target are the same point; move one of them");
        return {scene::ViewCamera::atPoints(eye, target, arguments.fovDegrees, scene.bounds), false};
    }
    if (arguments.camera.empty())
        return defaultCamera(arguments, scene, aspect);
    std::string known;
    for (const auto& camera : scene.cameras) {
        if (camera.name == arguments.camera)
            return {camera};
        known += " " + camera.name;
    }
    size_t index = scene.cameras.size();
    const char* end = arguments.camera.data() + arguments.camera.size();
    const auto parsed = std::from_chars(arguments.camera.data(), end, index);
    if (parsed.ec == std::errc() && parsed.ptr == end && index < scene.cameras.size())
        return {scene.cameras[index]};
    throw Error(fmt::format("{}: no camera '{}'; it has{}", arguments.scene.string(), arguments.camera,
                            known.empty() ? " none: leave --camera out" : known));
}

bool hasOwnLights(const SceneArguments& arguments, const scene::Scene& scene)
{
    return !scene.lights.empty() && arguments.lights == 0 && arguments.lightList.empty();
}

float chooseExposure(const SceneArguments& arguments, const scene::Scene& scene, Renderer& renderer,
                     const scene::Camera& camera)
{
    const bool perScene = arguments.exposure == ExposureChoice::perScene;
    if (arguments.exposure == ExposureChoice::fixed || (perScene && !hasOwnLights(arguments, scene)))
        return arguments.settings.exposure;
    const LuminanceHistogram histogram = renderer.meter(camera);
    if (perScene && !needsExposure(histogram))
        return arguments.settings.exposure;
    const float exposure = automaticExposure(histogram);
    spdlog::info("exposure {} (auto)", exposure);
    return exposure;
}

std::map<std::string, std::string> settingTexts(const Settings& settings)
{
    std::map<std::string, std::string> texts;
    forEachSetting([&](const auto& setting) { texts[setting.name] = textOf(setting, settings); });
    return texts;
}

RunInfo describeRun(const SceneArguments& arguments, const PathOptions& path, const scene::Camera& camera,
                    const gpu::Device& device)
{
    const Settings& settings = arguments.settings;
    RunInfo run{.version = LUMEL_VERSION,
                .device = device.properties().deviceName.data(),
                .driver = device.driver(),
                .scene = arguments.scene.string(),
                .shading = kShadingNames[size_t(settings.shading)],
                .filter = kFilterNames[size_t(arguments.filter)],
                .width = settings.size.x,
                .height = settings.size.y,
                .budgetMs = settings.budgetMs,
                .options = {{"camera", camera.name},
                            {"path", kPathNames[size_t(path.path)]},
                            {"step", text(path.stepOrDefault())},
                            {"model", kModelNames[size_t(arguments.model)]},
                            {"lobes", kLobeNames[size_t(arguments.lobes)]},
                            {"environment", arguments.environment.empty() ? "auto" : arguments.environment}}};
    run.options.merge(settingTexts(settings));
    if (arguments.lights > 0)
        run.options["lights"] = std::to_string(arguments.lights);
    if (path.seconds) {
        run.options["time"] = text(*path.seconds);
        run.options["time-step"] = text(path.timeStep);
    }
    return run;
}

std::vector<ObjectStats> objectsOf(const std::vector<scene::Object>& objects, const Renderer& renderer)
{
    std::vector<ObjectStats> stats = renderer.objectStats();
    for (size_t i = 0; i < stats.size(); ++i)
        stats[i].name = objects[i].name;
    return stats;
}

void checkValidation(const gpu::Device& device)
{
    if (!device.validationMessages().empty())
        throw Error(
            fmt::format("Vulkan validation: {} messages; report them", device.validationMessages().size()));
}

void changeScene(const SceneArguments& arguments, scene::Scene& scene)
{
    if (arguments.lights > 0)
        scene.lights = scene::lightRing(arguments.lights, scene.bounds);
    if (!arguments.lightList.empty())
        scene.lights = arguments.lightList;
    scene.environment = scene::chooseEnvironment(arguments.environment, scene);
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
