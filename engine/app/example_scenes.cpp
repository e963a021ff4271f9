#include "example_scenes.h"
#include "core/error.h"
#include <fmt/format.h>

namespace lumel {

std::filesystem::path exampleScene(const std::string& name)
{
    std::error_code code;
    const auto folder = std::filesystem::read_symlink("/proc/self/exe", code).parent_path();
    const auto file = std::filesystem::path(name) / (name + ".gltf");
    const auto installed = folder.parent_path() / "share" / "lumel" / "assets" / file;
    if (std::filesystem::exists(installed, code))
        return installed;
    const auto built = folder / "assets" / file;
    if (std::filesystem::exists(built, code))
        return built;
    throw Error(fmt::format("{}: the example scene is missing; build it (./run build) or name a scene",
                            built.string()));
}

} // namespace lumel
