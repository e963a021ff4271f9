// The commands: options in, then the steps in order. Exit code 0 done, 1 bad input or failure, 2 usage.
#include "commands.h"
#include "core/error.h"
#include "core/log.h"
#include "core/progress.h"
#include "shared/structs.h"
#include <CLI/CLI.hpp>
#include <set>

namespace {

using namespace lumel;

// "960x540" -> two numbers; CLI11 reports the returned text.
std::string parseSize(const std::string& text, glm::uvec2& size)
{
    int used = 0;
    if (std::sscanf(text.c_str(), "%ux%u%n", &size.x, &size.y, &used) != 2 || size_t(used) != text.size() ||
        size.x < 1 || size.y < 1 || size.x > 8192 || size.y > 8192)
        return "--size " + text + ": write WIDTHxHEIGHT, each 1 to 8192";
    return {};
}

std::string parsePoint(const std::string& text, std::optional<glm::vec3>& point)
{
    glm::vec3 p;
    int used = 0;
    if (std::sscanf(text.c_str(), "%f,%f,%f%n", &p.x, &p.y, &p.z, &used) != 3 || size_t(used) != text.size())
        return text + ": write x,y,z in metres";
    point = p;
    return {};
}

const std::map<std::string, baker::Method> kMethods = {
    {"fit", baker::Method::fit},       {"average", baker::Method::average}, {"flat", baker::Method::flat},
    {"height", baker::Method::height}, {"toksvig", baker::Method::toksvig}, {"lean", baker::Method::lean}};
constexpr const char* kMethodHelp =
    "how coarser texels are made: fit, average, flat, height, toksvig or lean";
const std::map<std::string, baker::Reconstruction> kReconstructions = {
    {"box", baker::Reconstruction::box}, {"bilinear", baker::Reconstruction::bilinear}};
const std::map<std::string, baker::Model> kModels = {{"ashikhmin-shirley", baker::Model::ashikhminShirley},
                                                     {"blinn-phong", baker::Model::blinnPhong}};
const std::map<std::string, Shading> kShadings = {
    {"tsl", Shading::tsl}, {"forward", Shading::forward}, {"reference", Shading::reference}};
const std::map<std::string, DrawFilter> kDrawFilters = {{"bilinear", DrawFilter::bilinear},
                                                        {"b-spline", DrawFilter::bspline},
                                                        {"catmull-rom", DrawFilter::catmullRom},
                                                        {"catmull-rom-16", DrawFilter::catmullRomExact}};
const std::map<std::string, scene::Path> kPaths = {
    {"still", scene::Path::still}, {"orbit", scene::Path::orbit}, {"dolly", scene::Path::dolly}};
const std::map<std::string, View> kViews = {
    {"level", View::level},     {"age", View::age},           {"lit", View::lit},
    {"density", View::density}, {"mode", View::mode},         {"charts", View::charts},
    {"normal", View::normal},   {"power", View::power},       {"anisotropy", View::anisotropy},
    {"diffuse", View::diffuse}, {"specular", View::specular}, {"error", View::error}};
const std::map<std::string, baker::Wrap> kWraps = {{"repeat", baker::Wrap::repeat},
                                                   {"clamp", baker::Wrap::clamp}};

void addBake(CLI::App& app, BakeArguments& a)
{
    CLI::App* command = app.add_subcommand("bake", "Fit reflectance MIPs to a height or normal map");
    auto* height = command->add_option("--height", a.height, "height map (channel 0)");
    command->add_option("--height-scale", a.heightScale, "height of value 1 in units of the map's width")
        ->needs(height);
    auto* normal = command->add_option("--normal", a.normal, "tangent-space normal map");
    normal->excludes(height);
    command->add_option("--normal-green", a.normalGreen, "which way the normal map's green points")
        ->check(CLI::IsMember({"up", "down"}))
        ->capture_default_str();
    command->add_option("--wrap", a.wrap, "what lies beyond the map's border: repeat or clamp")
        ->transform(CLI::CheckedTransformer(kWraps).description(""))
        ->default_str("repeat");
    command->add_option("--power", a.power, "Blinn-Phong power of every texel")->capture_default_str();
    command->add_option("--power-map", a.powerMap, "Blinn-Phong power, as stored (channel 0, float image)");
    command->add_option("--roughness", a.roughness,
                        "glTF perceptual roughness (channel 0) in place of a power");
    command
        ->add_option("--anisotropic-power", a.anisotropicPower,
                     "base power along T and B in place of one power: --anisotropic-power 400 20")
        ->expected(2)
        ->check(CLI::PositiveNumber);
    command->add_option("--tangent-rotation", a.tangentRotation,
                        "turns the anisotropy axes by 0 to pi (channel 0 from 0 to 1)");
    command->add_option("--specular", a.specular, "Ks: a number, r,g,b or an image")->capture_default_str();
    command->add_option("--diffuse", a.diffuse, "Kd: a number, r,g,b or an image")->capture_default_str();
    command->add_option("--model", a.options.model, "lobe to fit: ashikhmin-shirley or blinn-phong")
        ->transform(CLI::CheckedTransformer(kModels).description(""))
        ->default_str("ashikhmin-shirley");
    command->add_option("--method", a.options.method, kMethodHelp)
        ->transform(CLI::CheckedTransformer(kMethods).description(""))
        ->default_str("fit");
    command->add_option("--reduce", a.options.reduce, "drop the N finest levels: level 0 is then fitted")
        ->check(CLI::Range(0, 13));
    command
        ->add_option("--reconstruction", a.options.reconstruction, "what a texel stands for: box or bilinear")
        ->transform(CLI::CheckedTransformer(kReconstructions).description(""))
        ->default_str("box");
    command->add_option("--threads", a.options.threads, "0 = all cores")->check(CLI::Range(0, 1024));
    command->add_flag("--float", a.asFloat, "store single precision in place of half");
    command->add_option("-o,--output", a.output, "OpenEXR file to write");
    command->add_option("--report", a.reports, "write how exact the bake is: .json, .html; may be repeated")
        ->take_all()
        ->expected(1)
        ->check(CLI::Validator(
            [](const std::string& file) {
                const bool known = file.ends_with(".json") || file.ends_with(".html");
                return known ? std::string() : file + ": end the name in .json or .html";
            },
            ""));
    auto* manifest = command->add_option("--manifest", a.manifest, "bake the maps that this JSON file lists");
    command->callback([&a, command, manifest] {
        if (manifest->count() > 0) {
            const std::set<std::string> defaults{"--manifest", "--threads", "--method", "--model"};
            for (const CLI::Option* option : command->get_options())
                if (option->count() > 0 && !defaults.contains(option->get_name()))
                    throw CLI::ExcludesError("--manifest", option->get_name());
            return;
        }
        if (a.height.empty() && a.normal.empty())
            throw CLI::RequiredError("--height or --normal");
        if (a.output.empty())
            throw CLI::RequiredError("--output");
    });
}

void addDeviceOptions(CLI::App* command, ShotArguments& a)
{
    command->add_option("--device", a.device.device, "Vulkan device, by index or part of its name");
    command->add_flag("--validate", a.device.validation,
                      "run under Vulkan validation; a message is a failure");
}

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

void addCamera(CLI::App* command, ShotArguments& a)
{
    command->add_option("--camera", a.camera, "camera of the file, by name or index");
    const auto addPoint = [&](const char* name, std::optional<glm::vec3>& point, const char* what) {
        command->add_option_function<std::string>(
            name,
            [&point](const std::string& text) {
                if (const auto error = parsePoint(text, point); !error.empty())
                    throw CLI::ValidationError(error);
            },
            what);
    };
    addPoint("--eye", a.eye, "camera position x,y,z");
    addPoint("--target", a.target, "point to look at x,y,z");
    command->add_option("--fov", a.fovDegrees, "vertical field of view in degrees, with --eye")
        ->check(CLI::Range(1.0, 170.0))
        ->capture_default_str();
}

void addShot(CLI::App& app, ShotArguments& a)
{
    CLI::App* command = app.add_subcommand("shot", "Render a glTF scene to a picture");
    command->add_option("scene", a.scene, "glTF 2.0 file, .gltf or .glb")->required();
    command->add_option("-o,--output", a.output, ".png (tone-mapped sRGB) or .exr (linear radiance)")
        ->required();
    command
        ->add_option_function<std::string>(
            "--size",
            [&a](const std::string& text) {
                if (const auto error = parseSize(text, a.settings.size); !error.empty())
                    throw CLI::ValidationError(error);
            },
            "picture size")
        ->default_str("960x540");
    addCamera(command, a);
    addPath(command, a);
    command
        ->add_option("--lights", a.lights,
                     "light the scene by N point and spot lights around it in place of its own")
        ->check(CLI::Range(1u, shared::kMaxLights));
    command->add_option("--shading", a.settings.shading, "tsl, forward or reference")
        ->transform(CLI::CheckedTransformer(kShadings).description(""))
        ->default_str("tsl");
    command
        ->add_option("--view", a.settings.view,
                     "show in place of the picture: level, age, lit, density, mode, charts, normal, power, "
                     "anisotropy, diffuse, specular or error")
        ->transform(CLI::CheckedTransformer(kViews).description(""));
    command->add_option("--filter", a.filter, kMethodHelp)
        ->transform(CLI::CheckedTransformer(kMethods).description(""))
        ->default_str("fit");
    command->add_option("--model", a.model, "lobe of materials: ashikhmin-shirley or blinn-phong")
        ->transform(CLI::CheckedTransformer(kModels).description(""))
        ->default_str("ashikhmin-shirley");
    command->add_option("--samples", a.settings.samples, "reference: samples a pixel")
        ->check(CLI::Range(1, 65536))
        ->capture_default_str();
    command
        ->add_option("--draw-filter", a.settings.filter,
                     "tsl: bilinear, b-spline, catmull-rom or catmull-rom-16")
        ->transform(CLI::CheckedTransformer(kDrawFilters).description(""));
    command
        ->add_option("--level-offset", a.settings.levelOffset,
                     "tsl: levels that lumels are coarser than one a pixel, at least")
        ->check(CLI::Range(-2.0, 8.0))
        ->capture_default_str();
    command
        ->add_option("--lumels-per-pixel", a.settings.lumelsPerPixel,
                     "tsl: everything gets coarser before a view needs more lumels a covered pixel")
        ->check(CLI::Range(0.1, 64.0))
        ->capture_default_str();
    command->add_option("--lumel-budget", a.settings.lumelBudget, "tsl: lumels lit a frame; the others wait")
        ->check(CLI::Range(64u, ~0u))
        ->default_str("unlimited");
    command
        ->add_option("--refresh-share", a.settings.refreshShare,
                     "tsl: share of the visible lumels lit again a frame because the camera moved")
        ->check(CLI::Range(0.0, 1.0))
        ->capture_default_str();
    command
        ->add_option("--tolerance", a.settings.tolerance,
                     "tsl: keep lumels expected to change by less than this display value")
        ->check(CLI::Range(0.0, 1.0))
        ->capture_default_str();
    command->add_option("--anisotropy", a.settings.anisotropy, "tsl: most taps along a footprint")
        ->check(CLI::Range(1.0, 16.0))
        ->capture_default_str();
    command->add_option("--msaa", a.settings.msaa, "coverage samples of tsl and forward")
        ->check(CLI::IsMember({1, 4}))
        ->capture_default_str();
    command->add_option("--exposure", a.settings.exposure, "display: multiplies radiance")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    command
        ->add_option_function<size_t>(
            "--pool-mb", [&a](size_t mb) { a.settings.poolBytes = mb << 20; },
            "cap of the lit textures' memory")
        ->check(CLI::Range(1, 65536))
        ->default_str("256");
    command->add_flag("!--no-cache", a.useCache, "bake materials anew, do not touch the cache");
    command->add_option("--threads", a.threads, "threads of the baker, 0 = all cores")
        ->check(CLI::Range(0, 1024));
    command->add_option("--stats", a.stats, "write the frames' statistics as JSON");
    addDeviceOptions(command, a);
}

void addCompare(CLI::App& app, CompareArguments& a)
{
    CLI::App* command = app.add_subcommand("compare", "Measure how two pictures differ");
    command->add_option("a", a.a, "picture (.exr is tone-mapped first)")->required();
    command->add_option("b", a.b, "picture of the same size")->required();
    command->add_option("-o,--output", a.output, "write four times the difference as a picture");
    command->add_option("--psnr-min", a.psnrMin, "exit 1 below this PSNR in dB");
}

int run(int argc, char** argv)
{
    CLI::App app("lumel: texture-space lighting with fitted reflectance MIPs");
    app.name("lumel");
    app.require_subcommand(1);
    app.set_version_flag("--version", LUMEL_VERSION);
    BakeArguments bake;
    ShotArguments shot;
    CompareArguments compare;
    addBake(app, bake);
    addShot(app, shot);
    addCompare(app, compare);
    app.add_subcommand("help", "Show this help");
    const std::string help = app.help(); // after parsing, CLI11 would print the subcommand's own
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& e) {
        if (e.get_exit_code() == 0)
            return app.exit(e); // --help, --version
        std::fprintf(stderr, "lumel: %s; see lumel --help\n", e.what());
        return 2;
    }
    if (app.got_subcommand("help"))
        std::fputs(help.c_str(), stdout);
    if (app.got_subcommand("bake"))
        runBake(bake);
    if (app.got_subcommand("shot"))
        runShot(shot);
    if (app.got_subcommand("compare"))
        return runCompare(compare) ? 0 : 1;
    return 0;
}

} // namespace

int main(int argc, char** argv)
{
    setUpLog("info");
    catchInterrupts();
    try {
        return run(argc, argv);
    } catch (const Interrupted&) {
        std::fputs("lumel: interrupted; nothing unfinished was written\n", stderr);
        return 130;
    } catch (const std::bad_alloc&) {
        std::fputs("lumel: out of memory; use smaller maps or a smaller --size\n", stderr);
        return 1;
    } catch (const std::exception& e) {
        std::fprintf(stderr, "lumel: %s\n", e.what());
        return 1;
    }
}
