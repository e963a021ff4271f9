#include "command_line.h"
#include "renderer/names.h"
#include "scene/light_text.h"
#include <fmt/format.h>

namespace lumel {
namespace {

// A word of a POSIX shell.
std::string quoted(const std::string& text)
{
    const bool plain =
        !text.empty() && text.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvw"
                                                "xyz0123456789_-+./,:=%") == std::string::npos;
    if (plain)
        return text;
    std::string result = "'";
    for (const char c : text)
        result += c == '\'' ? "'\\''" : std::string(1, c);
    return result + "'";
}

// Names an option whose value differs from the default.
class Options {
public:
    template<class T>
    void add(const char* name, const T& value, const T& usual)
    {
        if (value != usual)
            set(name, fmt::format("{}", value)); // the shortest text that is read as the same number
    }
    template<class Enum, size_t count>
    void add(const char* name, Enum value, Enum usual, const std::array<const char*, count>& names)
    {
        if (value != usual)
            set(name, names.at(size_t(value)));
    }
    void set(const char* name, const std::string& value)
    {
        text_ += fmt::format(" {} {}", name, quoted(value));
    }
    const std::string& text() const { return text_; }

private:
    std::string text_;
};

void addSettings(Options& options, const Settings& s)
{
    const Settings defaults;
    options.add("--shading", s.shading, defaults.shading, kShadingNames);
    options.add("--view", s.view, defaults.view, kViewNames);
    if (s.shading == Shading::reference)
        options.add("--samples", s.samples, defaults.samples);
    options.add("--draw-filter", s.filter, defaults.filter, kDrawFilterNames);
    options.add("--level-offset", s.levelOffset, defaults.levelOffset);
    options.add("--lumels-per-pixel", s.lumelsPerPixel, defaults.lumelsPerPixel);
    options.add("--lumel-budget", s.lumelBudget, defaults.lumelBudget);
    options.add("--refresh-share", s.refreshShare, defaults.refreshShare);
    options.add("--tolerance", s.tolerance, defaults.tolerance);
    options.add("--anisotropy", s.anisotropy, defaults.anisotropy);
    options.add("--msaa", s.msaa, defaults.msaa);
    options.add("--environment-intensity", s.environmentIntensity, defaults.environmentIntensity);
    options.add("--environment-rotation", s.environmentRotation, defaults.environmentRotation);
    if (s.ambient)
        options.set("--ambient", fmt::format("{}", *s.ambient));
    if (!s.shadows)
        options.set("--shadows", "off");
    options.add("--shadow-size", s.shadowSize, defaults.shadowSize);
    options.add("--tone-map", s.toneMap, defaults.toneMap, kToneMapNames);
    options.add("--pool-mb", s.poolBytes >> 20, defaults.poolBytes >> 20);
}

} // namespace

std::string shotCommand(const SceneArguments& a, const scene::ViewCamera& camera,
                        std::optional<double> seconds, const std::filesystem::path& output)
{
    const SceneArguments defaults;
    Options options;
    options.set("-o", output.string());
    options.set("--size", fmt::format("{}x{}", a.settings.size.x, a.settings.size.y));
    const scene::Camera& c = camera.camera();
    const auto point = [](glm::vec3 p) { return fmt::format("{},{},{}", p.x, p.y, p.z); };
    if (camera.moved()) {
        options.set("--eye", point(c.eye));
        options.set("--target", point(c.target));
        options.add("--fov", camera.fovDegrees(), defaults.fovDegrees);
    } else if (!a.camera.empty()) {
        options.set("--camera", a.camera);
    }
    if (seconds)
        options.set("--time", fmt::format("{}", *seconds));
    if (a.environment == "none" || a.environment == "sky")
        options.set("--environment", a.environment);
    else if (!a.environment.empty())
        options.set("--environment", std::filesystem::absolute(a.environment).string());
    options.add("--lights", a.lights, defaults.lights);
    for (const scene::Light& light : a.lightList)
        options.set("--light", scene::lightText(light));
    for (const auto& [name, file] : a.materialFiles)
        options.set("--material", name + "=" + std::filesystem::absolute(file).string());
    options.add("--filter", a.filter, defaults.filter, kFilterNames);
    options.add("--model", a.model, defaults.model, kModelNames);
    addSettings(options, a.settings);
    if (a.exposure == ExposureChoice::fixed || a.settings.exposure != defaults.settings.exposure)
        options.set("--exposure", fmt::format("{}", a.settings.exposure));
    options.add("--device", a.device.device, defaults.device.device);
    return "lumel shot " + quoted(std::filesystem::absolute(a.scene).string()) + options.text();
}

} // namespace lumel
