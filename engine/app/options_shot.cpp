#include "options.h"

namespace lumel {
void addShot(CLI::App& app, ShotArguments& a)
{
    CLI::App* command = app.add_subcommand("shot", "Render a glTF scene to a picture");
    command->add_option("scene", a.scene, "glTF 2.0 file, .gltf or .glb")->required();
    command->add_option("-o,--output", a.output, ".png (tone-mapped sRGB) or .exr (linear radiance)")
        ->required();
    addSceneOptions(command, a);
    command->add_option("--frames", a.frames, "frames to render; the last is written, or with f_%04d.png all")
        ->check(CLI::Range(1, 100000))
        ->capture_default_str();
    addPathOptions(command, a.path);
    command->callback([&a] { checkPath(a.path); });
    command->add_option("--stats", a.stats, "write the frames' statistics as JSON");
}

} // namespace lumel
