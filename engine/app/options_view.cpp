#include "options.h"
#include "renderer/names.h"

namespace lumel {
namespace {

const std::map<std::string, gpu::PresentMode> kPresentModes = {{"fifo", gpu::PresentMode::fifo},
                                                               {"mailbox", gpu::PresentMode::mailbox},
                                                               {"immediate", gpu::PresentMode::immediate}};
const std::map<std::string, Shading> kSideShadings = {{kShadingNames[0], Shading::tsl},
                                                      {kShadingNames[1], Shading::forward},
                                                      {kShadingNames[2], Shading::reference}};

} // namespace

void addView(CLI::App& app, ViewArguments& a)
{
    CLI::App* command = app.add_subcommand("view", "Look around in a glTF scene, in a window");
    a.settings.size = {1280, 720};
    command->add_option("scene", a.scene, "glTF 2.0 file, .gltf or .glb; none = the record");
    addSceneOptions(command, a);
    command->get_option("--size")->description("size of the window")->default_str("1280x720");
    command->add_flag("--split", a.split, "compare with a second picture, at the right");
    command->add_option("--right-shading", a.rightShading, "the right picture's: tsl, forward or reference")
        ->transform(CLI::CheckedTransformer(kSideShadings).description(""))
        ->default_str("reference");
    command->add_option("--right-filter", a.rightFilter, "the right picture's; see --filter")
        ->transform(CLI::CheckedTransformer(kMethods).description(""))
        ->default_str("fit");
    command->add_option("--present", a.presentMode, "fifo (waits for the display), mailbox or immediate")
        ->transform(CLI::CheckedTransformer(kPresentModes).description(""))
        ->default_str("fifo");
    command->add_flag("!--no-panels", a.panels, "hide the panels; H shows them");
    command->add_option("--time", a.seconds,
                        "second of the scene's animation to show; without it, the animation plays");
    command->add_flag("--list-devices", a.listDevices, "print the Vulkan devices by index, and end");
}

} // namespace lumel
