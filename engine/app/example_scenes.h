// The example scenes that come with the program.
#pragma once
#include <filesystem>
#include <string>

namespace lumel {

// The glTF file of an example scene: where `cmake --install` puts it, ../share/lumel/assets from the program,
// else where the build makes it, assets beside the program. Throws Error where it is in neither.
std::filesystem::path exampleScene(const std::string& name);

} // namespace lumel
