// All commands, and those that have few options of their own.
#include "options.h"
#include "option_types.h"

namespace lumel {
namespace {

constexpr std::array kPresentModeNames{"fifo", "mailbox", "immediate"}; // gpu::PresentMode

} // namespace

void addShot(CommandLine& line, ShotArguments& a)
{
    Command command = line.add("shot", "Render a glTF scene to a picture");
    addText(command, "scene", "FILE", "glTF 2.0 file, .gltf or .glb", a.scene).required();
    addText(command, "-o,--output", "FILE", ".png (tone-mapped sRGB) or .exr (linear radiance)", a.output)
        .required();
    addSceneOptions(command, a);
    addQuick(command, a);
    addNumber(command, "--frames", 1, 100000, "",
              "frames to render; the last is written, or all to a name such as f_%04d.png", a.frames);
    addPathOptions(command, a.path);
    command.afterParsing([&a] { checkPath(a.path); });
    addText(command, "--stats", "FILE", "write the statistics of the frames as JSON", a.stats);
}

void addView(CommandLine& line, ViewArguments& a)
{
    Command command = line.add("view", "View a glTF scene in a window");
    a.settings.size = {1280, 720};
    addText(command, "scene", "FILE", "glTF 2.0 file, .gltf or .glb", a.scene).byDefault("the record");
    addSceneOptions(command, a);
    command.get("--size").describe("size of the window in pixels");
    command.addFlag("--split", "compare with a second picture on the right", a.split);
    addChoice(command, "--right-shading", kShadingNames, "--shading of the right picture", a.rightShading);
    addChoice(command, "--right-filter", kFilterNames, "--filter of the right picture", a.rightFilter);
    addChoice(command, "--present", kPresentModeNames, "present mode; fifo waits for vertical sync",
              a.presentMode);
    command.addFlag("!--no-panels", "hide the panels; H shows them", a.panels);
    addNumber(command, "--time", 0, 1e6, "seconds",
              "stop the scene's animation at this time; without it, the animation plays", a.seconds);
    command.addFlag("--list-devices", "print the Vulkan devices by index, and exit", a.listDevices);
}

void addCompare(CommandLine& line, CompareArguments& a)
{
    Command command = line.add("compare", "Measure the difference between two pictures");
    addText(command, "a", "FILE", "picture; .exr is tone-mapped first", a.a).required();
    addText(command, "b", "FILE", "picture of the same size", a.b).required();
    addText(command, "-o,--output", "FILE", "write four times the difference as a picture", a.output);
    addNumber(command, "--psnr-min", -1e6, 1e6, "dB", "exit with 1 below this PSNR", a.psnrMin);
}

void addHelp(CommandLine& line, HelpArguments& a)
{
    Command command = line.add("help", "Show the commands, or the options of one");
    addText(command, "command", "COMMAND", "command whose options are shown", a.command).byDefault("all");
    command.addFlag("--markdown", "write the reference of all commands as Markdown", a.markdown);
}

void addCommands(CommandLine& line, Arguments& arguments)
{
    addBake(line, arguments.bake);
    addExport(line, arguments.exported);
    addShot(line, arguments.shot);
    addView(line, arguments.view);
    addCompare(line, arguments.compare);
    addBench(line, arguments.bench);
    addHelp(line, arguments.help);
}

} // namespace lumel
