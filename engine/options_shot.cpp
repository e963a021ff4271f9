#include "options.h"

namespace lumel {
namespace {

void addPath(CLI::App* command, ShotArguments& a)
{
    command->add_option("--frames", a.frames, "frames to render; the last is written, or with f_%04d.png all")
        ->check(CLI::Range(1, 100000))
        ->capture_default_str();
    command->add_option("--path", a.path, "how the camera moves: still, orbit or dolly")
        ->transform(CLI::CheckedTransformer(kPaths).description(""))
        ->default_str("still");
    command
        ->add_option("--step", a.step,
                     "orbit: degrees a frame (0.5); dolly: percent of the distance a frame (1)")
        ->check(CLI::Range(-1000.0, 1000.0));
    command->callback([&a] {
        if (a.path == scene::Path::dolly && a.step && *a.step >= 100.0)
            throw CLI::ValidationError("--step", "a dolly of 100 percent or more passes its target");
    });
}

} // namespace

void addShot(CLI::App& app, ShotArguments& a)
{
    CLI::App* command = app.add_subcommand("shot", "Render a glTF scene to a picture");
    command->add_option("scene", a.scene, "glTF 2.0 file, .gltf or .glb")->required();
    command->add_option("-o,--output", a.output, ".png (tone-mapped sRGB) or .exr (linear radiance)")
        ->required();
    addSceneOptions(command, a);
    addPath(command, a);
    command->add_option("--stats", a.stats, "write the frames' statistics as JSON");
}

} // namespace lumel
