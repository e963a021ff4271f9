// What every command that renders takes: the settings of the table, and what is rendered from where.
#include "core/error.h"
#include "option_types.h"
#include "options.h"
#include "scene/light_text.h"
#include "shared/structs.h"

namespace lumel {
namespace {

template<class T>
void addSetting(Command& command, const Setting<T>& setting, Settings& settings)
{
    std::string shadings; // "tsl, forward: "
    for (size_t i = 0; i < kShadingNames.size() && setting.shadings != kAllShadings; ++i)
        if (setting.shadings & 1u << i)
            shadings += (shadings.empty() ? "" : ", ") + std::string(kShadingNames[i]);
    const auto read = [&setting, &settings](const std::string& text) -> std::string {
        const auto value = valueFrom(setting, text);
        settings.*setting.member = value.value_or(settings.*setting.member);
        return value ? "" : notIn(takes(setting));
    };
    command
        .add("--" + std::string(setting.name), takes(setting),
             shadings + (shadings.empty() ? "" : ": ") + setting.help, read)
        .byDefault(setting.defaultText ? setting.defaultText : textOf(setting, settings));
}

// An exposure may also be left to the picture.
void addExposure(Command& command, const Setting<float>& setting, SceneArguments& a)
{
    const auto read = [&](const std::string& text) -> std::string {
        a.exposure = text == "auto" ? ExposureChoice::automatic : ExposureChoice::fixed;
        if (a.exposure == ExposureChoice::automatic)
            return "";
        const auto value = valueFrom(setting, text);
        a.settings.exposure = value.value_or(1.0f);
        return value ? "" : notIn(takes(setting) + "|auto");
    };
    command.add("--exposure", takes(setting) + "|auto", setting.help, read).byDefault(setting.defaultText);
}

void addSettings(Command& command, SceneArguments& a)
{
    forEachSetting([&](const auto& setting) {
        if constexpr (std::is_same_v<decltype(setting.member), float Settings::*>)
            if (describes(setting, &Settings::exposure))
                return addExposure(command, setting, a);
        addSetting(command, setting, a.settings);
    });
    command.afterParsing([&a] {
        if (a.environment == "none" && !a.settings.ambient) // none is none
            a.settings.ambient = 0.0f;
    });
}

void addPoint(Command& command, const char* name, const char* help, std::optional<glm::vec3>& point)
{
    command.add(name, "X,Y,Z", help, [&point](const std::string& text) -> std::string {
        glm::vec3 p;
        int used = 0;
        const int count = std::sscanf(text.c_str(), "%f,%f,%f%n", &p.x, &p.y, &p.z, &used);
        if (count != 3 || size_t(used) != text.size())
            return "write X,Y,Z in metres";
        point = p;
        return "";
    });
}

void addCamera(Command& command, SceneArguments& a)
{
    addText(command, "--camera", "NAME|INDEX", "camera of the scene", a.camera);
    addPoint(command, "--eye", "position of the camera", a.eye);
    addPoint(command, "--target", "point that the camera looks at", a.target);
    addNumber(command, "--fov", 1, 170, "degrees", "vertical field of view, with --eye or --target",
              a.fovDegrees);
}

std::string readLight(const std::string& text, SceneArguments& a)
{
    try {
        a.lightList.push_back(scene::parseLight(text));
    } catch (const Error& e) {
        return e.what();
    }
    return "";
}

std::string readMaterial(const std::string& text, SceneArguments& a)
{
    const size_t equals = text.find('=');
    if (equals == std::string::npos || equals + 1 == text.size())
        return "write NAME=FILE.exr";
    a.materialFiles.emplace_back(text.substr(0, equals), text.substr(equals + 1));
    return "";
}

void addScene(Command& command, SceneArguments& a)
{
    command.add("--lights", fmt::format("1..{}", shared::kMaxLights),
                "light the scene by N point and spot lights around it in place of its own",
                numberReader<int>(1, shared::kMaxLights, [&a](int count) { a.lights = count; }));
    command.addRepeated("--light", "LIGHT",
                        "a light in place of the scene's, may be repeated: sun,DX,DY,DZ,R,G,B,LUX or "
                        "point,X,Y,Z,R,G,B,CANDELA[,RANGE] or "
                        "spot,X,Y,Z,R,G,B,CANDELA,RANGE,DX,DY,DZ,INNER,OUTER",
                        [&a](const std::string& text) { return readLight(text, a); });
    addText(
        command, "--environment", "none|sky|FILE",
        "environment that lights the scene: none, a procedural sky, or an equirectangular map, .hdr or .exr",
        a.environment)
        .byDefault("sky where the scene has no lights, else none");
    command.addRepeated("--material", "NAME=FILE",
                        "a baked .exr in place of a material's maps, may be repeated",
                        [&a](const std::string& text) { return readMaterial(text, a); });
    addChoice(command, "--filter", kFilterNames, kFilterHelp, a.filter);
    addChoice(command, "--model", kModelNames, "specular lobe of materials", a.model);
    addChoice(command, "--lobes", kLobeNames, kLobesHelp, a.lobes);
    command.afterParsing([&a, command] {
        const auto given = [&](const char* name) { return command.get(name).given(); };
        a.asked = {.method = given("--filter"), .model = given("--model"), .lobes = given("--lobes")};
    });
}

void addMachine(Command& command, SceneArguments& a)
{
    command.addFlag("!--no-cache", "bake materials again and leave the cache alone", a.useCache);
    addNumber(command, "--threads", 0, 1024, "", "threads of the baker; 0: one per core", a.threads);
    addText(command, "--device", "INDEX|NAME",
            "Vulkan device, by index or a part of its or its driver's name", a.device.device)
        .environment("LUMEL_DEVICE");
    command
        .addFlag("--validate", "run under the Vulkan validation layer; a message is a failure",
                 a.device.validation)
        .environment("LUMEL_VALIDATE");
}

} // namespace

void addSceneOptions(Command& command, SceneArguments& a)
{
    addCamera(command, a);
    addScene(command, a);
    addSettings(command, a);
    addMachine(command, a);
}

void addQuick(Command& command, SceneArguments& a)
{
    command.addFlag(
        "--quick",
        "do not wait for materials to be baked: those that are not in the cache get closed forms, "
        "which is said",
        a.quick);
}

void addPathOptions(Command& command, PathOptions& path)
{
    addChoice(command, "--path", kPathNames, "camera path", path.path);
    addNumber(command, "--step", -1000, 1000, "",
              "orbit: degrees per frame; dolly, pan: percent of the distance to the target per frame",
              path.step)
        .byDefault("orbit 0.5, dolly 1, pan 0.1");
    addNumber(command, "--time", 0, 1e6, "seconds", "time of the scene's animation in the first frame",
              path.seconds);
    addNumber(command, "--time-step", 0, 1e3, "seconds", "time of the animation from frame to frame",
              path.timeStep)
        .byDefault("1/30");
}

void checkPath(const PathOptions& path)
{
    if (path.path == scene::Path::dolly && path.step && *path.step >= 100.0)
        throw UsageError("--step: a dolly of 100 percent or more passes its target");
}

} // namespace lumel
