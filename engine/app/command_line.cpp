#include "command_line.h"
#include "renderer/setting_text.h"
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
    void add(const char* name, const T& value, const T& byDefault)
    {
        if (value != byDefault)
            set(name, fmt::format("{}", value)); // the shortest text that is read as the same number
    }
    template<class Enum, size_t count>
    void add(const char* name, Enum value, Enum byDefault, const std::array<const char*, count>& names,
             bool always)
    {
        if (always || value != byDefault)
            set(name, names.at(size_t(value)));
    }
    void set(const std::string& name, const std::string& value)
    {
        text_ += fmt::format(" {} {}", name, quoted(value));
    }
    const std::string& text() const { return text_; }

private:
    std::string text_;
};

void addSettings(Options& options, const SceneArguments& a)
{
    forEachSetting([&](const auto& setting) {
        const std::string text = textOf(setting, a.settings);
        const bool chosen = describes(setting, &Settings::exposure) && a.exposure == ExposureChoice::fixed;
        if (chosen || (appliesTo(setting, a.settings) && text != textOf(setting, Settings())))
            options.set("--" + std::string(setting.name), text);
    });
}

} // namespace

std::string shotCommand(const SceneArguments& a, const scene::ViewCamera& camera,
                        std::optional<double> seconds, const std::filesystem::path& output)
{
    const SceneArguments defaults;
    Options options;
    options.set("-o", output.string());
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
    options.add("--filter", a.filter, defaults.filter, kFilterNames, a.asked.method);
    options.add("--model", a.model, defaults.model, kModelNames, a.asked.model);
    options.add("--lobes", a.lobes, defaults.lobes, kLobeNames, a.asked.lobes);
    addSettings(options, a);
    options.add("--device", a.device.device, defaults.device.device);
    return "lumel shot " + quoted(std::filesystem::absolute(a.scene).string()) + options.text();
}

} // namespace lumel
