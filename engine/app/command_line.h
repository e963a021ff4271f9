// The command that renders what the viewer shows.
#pragma once
#include "commands.h"
#include "scene/view_camera.h"

namespace lumel {

// A `lumel shot` line for a shell, with every option that differs from its default. `camera` has the name
// that --camera takes unless it has been moved.
std::string shotCommand(const SceneArguments& arguments, const scene::ViewCamera& camera,
                        std::optional<double> seconds, const std::filesystem::path& output);

} // namespace lumel
