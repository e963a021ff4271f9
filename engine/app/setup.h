// What the commands that render have in common before the first frame, and how they describe a run.
#pragma once
#include "commands.h"
#include "renderer/stats.h"

namespace lumel {

// Of the device that the options name, for rendering.
gpu::DeviceOptions deviceOptions(const SceneArguments& arguments);

struct ChosenCamera {
    scene::Camera camera;
    bool named = true; // --camera takes its name
};
// The camera that the options name; without any the file's first, or one that frames the scene where that
// sees nothing, which is said. Throws Error when the scene has none of that name.
ChosenCamera chooseCamera(const SceneArguments& arguments, const scene::Scene& scene);

// Whether the scene is lit by the lights of its file, in units that may be any.
bool hasOwnLights(const SceneArguments& arguments, const scene::Scene& scene);

// The exposure that the options ask for; where it is chosen here, by what the camera sees, that is said. The
// renderer's scene is as it is to be shown.
float chooseExposure(const SceneArguments& arguments, const scene::Scene& scene, Renderer& renderer,
                     const scene::Camera& camera);

// Every setting by its option's name, as the statistics have it.
std::map<std::string, std::string> settingTexts(const Settings& settings);

// The head of the statistics.
RunInfo describeRun(const SceneArguments& arguments, const PathOptions& path, const scene::Camera& camera,
                    const gpu::Device& device);

// Statistics of the last frame's objects with their names. `objects`: the scene's, as rendered.
std::vector<ObjectStats> objectsOf(const std::vector<scene::Object>& objects, const Renderer& renderer);

// Throws Error when --validate found something.
void checkValidation(const gpu::Device& device);

// What the options change about a scene just loaded: its lights, the baked files of its materials. Throws
// Error when there is no such material.
void changeScene(const SceneArguments& arguments, scene::Scene& scene);

} // namespace lumel
