// What the commands that render have in common before the first frame.
#pragma once
#include "commands.h"

namespace lumel {

// The camera that the options name. Throws Error when the scene has none of that name.
scene::Camera chooseCamera(const SceneArguments& arguments, const scene::Scene& scene);

// What the options change about a scene just loaded: its lights, the baked files of its materials. Throws
// Error when there is no such material.
void changeScene(const SceneArguments& arguments, scene::Scene& scene);

} // namespace lumel
