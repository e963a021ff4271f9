#include "core/error.h"
#include "options.h"
#include "renderer/names.h"
#include "scene/light_text.h"
#include "shared/structs.h"
#include <charconv>
#include <cmath>

namespace lumel {

const std::map<std::string, scene::Path> kPaths = {{"still", scene::Path::still},
                                                   {"orbit", scene::Path::orbit},
                                                   {"dolly", scene::Path::dolly},
                                                   {"pan", scene::Path::pan},
                                                   {"animation", scene::Path::animation}};

// "960x540" -> two numbers; CLI11 reports the returned text.
std::string parseSize(const std::string& text, glm::uvec2& size)
{
    int used = 0;
    if (std::sscanf(text.c_str(), "%ux%u%n", &size.x, &size.y, &used) != 2 || size_t(used) != text.size() ||
        size.x < 1 || size.y < 1 || size.x > 8192 || size.y > 8192)
        return "--size " + text + ": write WIDTHxHEIGHT, each 1 to 8192";
    return {};
}

namespace {

std::string parsePoint(const std::string& text, std::optional<glm::vec3>& point)
{
    glm::vec3 p;
    int used = 0;
    if (std::sscanf(text.c_str(), "%f,%f,%f%n", &p.x, &p.y, &p.z, &used) != 3 || size_t(used) != text.size())
        return text + ": write x,y,z in metres";
    point = p;
    return {};
}

// Option values from a list of names in an enum's order.
template<class Enum, size_t count>
std::map<std::string, Enum> valuesOf(const std::array<const char*, count>& names, size_t first = 0)
{
    std::map<std::string, Enum> values;
    for (size_t i = first; i < count; ++i)
        values.emplace(names[i], Enum(i));
    return values;
}

const auto kShadings = valuesOf<Shading>(kShadingNames);
const auto kDrawFilters = valuesOf<DrawFilter>(kDrawFilterNames);
const auto kToneMaps = valuesOf<ToneMap>(kToneMapNames);
const auto kViews = valuesOf<View>(kViewNames, 1);

void addDeviceOptions(CLI::App* command, SceneArguments& a)
{
    command
        ->add_option("--device", a.device.device,
                     "Vulkan device, by index or part of its or its driver's name")
        ->envname("LUMEL_DEVICE");
    command
        ->add_flag("--validate", a.device.validation, "run under Vulkan validation; a message is a failure")
        ->envname("LUMEL_VALIDATE");
}

void parseExposure(const std::string& text, SceneArguments& a)
{
    a.exposure = text == "auto" ? ExposureChoice::automatic : ExposureChoice::fixed;
    if (a.exposure == ExposureChoice::automatic)
        return;
    float& number = a.settings.exposure;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc() || end != text.data() + text.size() || !(number > 0.0f && std::isfinite(number)))
        throw CLI::ValidationError("--exposure " + text, "write auto or a number above 0");
}

void addCamera(CLI::App* command, SceneArguments& a)
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

void addReplacements(CLI::App* command, SceneArguments& a)
{
    command
        ->add_option_function<std::vector<std::string>>(
            "--light",
            [&a](const std::vector<std::string>& texts) {
                for (const std::string& text : texts) {
                    try {
                        a.lightList.push_back(scene::parseLight(text));
                    } catch (const Error& e) {
                        throw CLI::ValidationError("--light", e.what());
                    }
                }
            },
            "a light in place of the scene's, may be repeated: sun,DX,DY,DZ,R,G,B,LUX or "
            "point,X,Y,Z,R,G,B,CANDELA[,RANGE] or "
            "spot,X,Y,Z,R,G,B,CANDELA,RANGE,DX,DY,DZ,INNER,OUTER")
        ->allow_extra_args(false);
    command
        ->add_option_function<std::vector<std::string>>(
            "--material",
            [&a](const std::vector<std::string>& texts) {
                for (const std::string& text : texts) {
                    const size_t equals = text.find('=');
                    if (equals == std::string::npos || equals + 1 == text.size())
                        throw CLI::ValidationError("--material", text + ": write NAME=FILE.exr");
                    a.materialFiles.emplace_back(text.substr(0, equals), text.substr(equals + 1));
                }
            },
            "a baked file in place of a material's maps, may be repeated: NAME=FILE.exr")
        ->allow_extra_args(false);
}

} // namespace

void addSceneOptions(CLI::App* command, SceneArguments& a)
{
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
    command
        ->add_option("--lights", a.lights,
                     "light the scene by N point and spot lights around it in place of its own")
        ->check(CLI::Range(1u, shared::kMaxLights));
    addReplacements(command, a);
    command
        ->add_option("--environment", a.environment,
                     "environment that lights the scene: none, sky, or an equirectangular map, .hdr "
                     "or .exr")
        ->default_str("sky where the scene has no lights, else none");
    command
        ->add_option("--environment-intensity", a.settings.environmentIntensity,
                     "multiplies the environment's radiance")
        ->check(CLI::Range(0.0, 1e6))
        ->capture_default_str();
    command
        ->add_option("--environment-rotation", a.settings.environmentRotation,
                     "rotates the environment about the vertical, in degrees")
        ->check(CLI::Range(-360.0, 360.0))
        ->capture_default_str();
    command
        ->add_option("--ambient", a.settings.ambient,
                     "radiance of an even sky, and a third of it from the ground, beside the environment")
        ->check(CLI::Range(0.0, 1e6))
        ->default_str("4 % of the brightest sun in a scene with lights of its own, else 0");
    command
        ->add_option_function<std::string>(
            "--shadows", [&a](const std::string& text) { a.settings.shadows = text == "on"; },
            "shadows of sun and spot lights, the 8 strongest: on or off")
        ->check(CLI::IsMember({"on", "off"}))
        ->default_str("on");
    command->add_option("--shadow-size", a.settings.shadowSize, "texels a side of each shadow map")
        ->check(CLI::Range(64u, 8192u))
        ->capture_default_str();
    command->add_option("--shading", a.settings.shading, "tsl, forward or reference")
        ->transform(CLI::CheckedTransformer(kShadings).description(""))
        ->default_str("tsl");
    command
        ->add_option(
            "--view", a.settings.view,
            "show in place of the picture: level, age, lit, density, overshading, pool, mode, charts, "
            "normal, power, anisotropy, diffuse, specular or error")
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
                     "tsl: grazing angles lose detail before a view needs more lumels a covered pixel")
        ->check(CLI::Range(0.1, 64.0))
        ->capture_default_str();
    command->add_option("--lumel-budget", a.settings.lumelBudget, "tsl: lumels lit a frame; the others wait")
        ->check(CLI::Range(64u, ~0u))
        ->default_str("unlimited");
    command
        ->add_option("--budget-ms", a.settings.budgetMs,
                     "hold each frame within this time: fewer lumels a frame, coarser ones, fewer pixels; "
                     "--msaa is then 1 unless given")
        ->check(CLI::Range(0.1, 10000.0))
        ->default_str("none");
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
    auto* msaa = command->add_option("--msaa", a.settings.msaa, "coverage samples of tsl and forward")
                     ->check(CLI::IsMember({1, 4}))
                     ->capture_default_str();
    // Four samples cost as much as twice the render scale.
    command->parse_complete_callback([&a, msaa] {
        if (a.settings.budgetMs > 0.0 && msaa->count() == 0)
            a.settings.msaa = 1;
        if (a.environment == "none" && !a.settings.ambient) // none is none
            a.settings.ambient = 0.0f;
    });
    command
        ->add_option_function<std::string>(
            "--exposure", [&a](const std::string& text) { parseExposure(text, a); },
            "display: multiplies radiance; a number, or auto: what brings the view to middle grey")
        ->default_str("1, or auto where the scene's own lights would give a white or black picture");
    command->add_option("--tone-map", a.settings.toneMap, "display: neutral (Khronos PBR), aces or clamp")
        ->transform(CLI::CheckedTransformer(kToneMaps).description(""))
        ->default_str("neutral");
    command
        ->add_option_function<size_t>(
            "--pool-mb", [&a](size_t mb) { a.settings.poolBytes = mb << 20; },
            "cap of the lit textures' memory")
        ->check(CLI::Range(1, 65536))
        ->default_str("256");
    command->add_flag("!--no-cache", a.useCache, "bake materials anew, do not touch the cache");
    command->add_option("--threads", a.threads, "threads of the baker, 0 = all cores")
        ->check(CLI::Range(0, 1024));
    addDeviceOptions(command, a);
}

void addPathOptions(CLI::App* command, PathOptions& path)
{
    command->add_option("--path", path.path, "how the camera moves: still, orbit, dolly, pan or animation")
        ->transform(CLI::CheckedTransformer(kPaths).description(""))
        ->default_str("still");
    command
        ->add_option("--step", path.step,
                     "orbit: degrees a frame (0.5); dolly, pan: percent of the distance a frame (1, 0.1)")
        ->check(CLI::Range(-1000.0, 1000.0));
    command->add_option("--time", path.seconds, "seconds of the scene's animation in the first frame")
        ->check(CLI::Range(0.0, 1e6));
    command->add_option("--time-step", path.timeStep, "seconds of the animation from frame to frame")
        ->check(CLI::Range(0.0, 1e3))
        ->default_str("1/30");
}

void checkPath(const PathOptions& path)
{
    if (path.path == scene::Path::dolly && path.step && *path.step >= 100.0)
        throw CLI::ValidationError("--step", "a dolly of 100 percent or more passes its target");
}

} // namespace lumel
