// What the viewer does when it is asked to: open, copy, save, reload.
#include "app/command_line.h"
#include "app/setup.h"
#include "core/error.h"
#include "core/file.h"
#include "core/image.h"
#include "gpu/shader_reload.h"
#include "scene/light_text.h"
#include "scene/pick.h"
#include "viewer.h"
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>

namespace lumel {

void Viewer::act(const ui::Layout& layout)
{
    const ui::Requests asked = std::exchange(state_.requests, {});
    state_.requests.quit = asked.quit;
    try {
        for (const auto& file : asked.open)
            open(file, asked.openAt, layout);
        if (!renderers_->scene())
            return;
        actOnCamera(asked, layout);
        if (state_.lightsEdited)
            for (scene::Light& light : state_.lights)
                light = scene::parseLight(scene::lightText(light)); // what the command's options say
        if (asked.copyCommand)
            copyCommand();
        if (asked.screenshotPng)
            takeScreenshot(".png");
        if (asked.screenshotExr)
            takeScreenshot(".exr");
        if (asked.reloadShaders)
            reloadShaders();
    } catch (const Interrupted&) {
        throw;
    } catch (const Error& e) {
        say(e.what(), true);
    }
    if (asked.fullscreen)
        toggleFullscreen();
}

void Viewer::actOnCamera(const ui::Requests& asked, const ui::Layout& layout)
{
    const auto scene = renderers_->scene();
    if (asked.reset)
        resetView();
    if (asked.camera >= 0) {
        arguments_.camera = std::to_string(asked.camera);
        state_.camera.reset(scene->cameras[size_t(asked.camera)], scene->bounds);
    }
    if (!asked.pick)
        return;
    const float aspect = layout.picture.x / layout.picture.y;
    const auto hit = scene::pick(*scene, scene::rayThrough(state_.camera.camera(), asked.pickAt, aspect));
    state_.selected = hit ? std::optional(hit->object) : std::nullopt;
    if (hit && asked.focus)
        state_.camera.focus(scene::worldBounds(*scene, hit->object));
}

void Viewer::open(const std::filesystem::path& file, glm::vec2 at, const ui::Layout& layout)
{
    const std::string extension = file.extension().string();
    if (extension == ".gltf" || extension == ".glb")
        beginLoading(file);
    else if (extension == ".exr")
        replaceMaterial(file, at, layout);
    else if (extension == ".hdr")
        state_.environment = file.string();
    else
        throw Error(
            fmt::format("{}: drop a .gltf or .glb scene, a .hdr environment, or a baked .exr on a surface",
                        file.filename().string()));
}

void Viewer::replaceMaterial(const std::filesystem::path& file, glm::vec2 at, const ui::Layout& layout)
{
    const auto scene = renderers_->scene();
    if (!scene)
        return;
    const float aspect = layout.picture.x / layout.picture.y;
    const auto hit = scene::pick(*scene, scene::rayThrough(state_.camera.camera(), at, aspect));
    if (!hit)
        throw Error(file.filename().string() +
                    ": drop a baked file on the surface whose material it replaces");
    auto changed = std::make_shared<scene::Scene>(*scene);
    scene::Material& material = changed->materials[size_t(scene->objects[hit->object].material)];
    for (scene::Material& other : changed->materials) // the option goes by name
        if (other.name == material.name)
            other.bakedFile = file;
    load_ = {.kind = Load::Kind::material, .file = file, .material = material.name};
    loader_.begin(arguments_.scene, bakeOptions(state_.sides[0].filter), changed);
}

SceneArguments Viewer::argumentsOf(size_t side) const
{
    SceneArguments a = arguments_;
    a.settings = renderers_->settings(side);
    a.settings.budgetMs = 0.0; // its quality depends on the machine's load
    if (a.settings.shading == Shading::reference)
        a.settings.samples = renderers_->samples(side);
    a.filter = renderers_->method(side);
    if (state_.lightsEdited) {
        a.lights = 0;
        a.lightList = state_.lights;
    }
    // What the command would choose by itself depends on the view.
    const bool chooses = state_.autoExposure || hasOwnLights(a, *renderers_->scene());
    a.exposure = chooses || state_.exposureChosen ? ExposureChoice::fixed : ExposureChoice::perScene;
    return a;
}

void Viewer::copyCommand()
{
    std::string text;
    for (size_t side = 0; side < (state_.split ? 2u : 1u); ++side) {
        if (!renderers_->picture(side))
            throw Error("nothing has been rendered yet; try again");
        const char* const name = !state_.split ? "lumel.png"
                                 : side == 0   ? "lumel-left.png"
                                               : "lumel-right.png";
        text += shotCommand(argumentsOf(side), state_.camera, state_.seconds, name) + "\n";
    }
    glfwSetClipboardString(frontend_.window, text.c_str());
    say("copied: " + text.substr(0, text.size() - 1));
}

void Viewer::takeScreenshot(const char* extension)
{
    std::string stem;
    do
        stem = fmt::format("lumel-{:03}", ++screenshots_);
    while (std::filesystem::exists(stem + ".txt"));
    std::string commands, names;
    for (size_t side = 0; side < (state_.split ? 2u : 1u); ++side) {
        if (!renderers_->picture(side))
            throw Error("nothing has been rendered yet; try again");
        const char* const suffix = !state_.split ? "" : side == 0 ? "-left" : "-right";
        const std::filesystem::path file = stem + suffix + extension;
        writeImage(file, renderers_->screenshot(state_, side, std::string_view(extension) == ".exr"));
        commands += shotCommand(argumentsOf(side), state_.camera, state_.seconds, file) + "\n";
        names += (names.empty() ? "" : ", ") + file.string();
    }
    writeFileAtomically(stem + ".txt", commands);
    say(fmt::format("saved {}, and the command in {}.txt", names, stem));
}

void Viewer::reloadShaders()
{
    gpu::reloadShaders();
    renderers_->restart();
    say("shaders reloaded");
}

void Viewer::toggleFullscreen()
{
    GLFWwindow* window = frontend_.window;
    if (glfwGetWindowMonitor(window)) {
        glfwSetWindowMonitor(window, nullptr, windowed_[0], windowed_[1], windowed_[2], windowed_[3], 0);
        return;
    }
    GLFWmonitor* monitor = glfwGetPrimaryMonitor();
    const GLFWvidmode* mode = monitor ? glfwGetVideoMode(monitor) : nullptr;
    if (!mode)
        return;
    glfwGetWindowPos(window, &windowed_[0], &windowed_[1]);
    glfwGetWindowSize(window, &windowed_[2], &windowed_[3]);
    glfwSetWindowMonitor(window, monitor, 0, 0, mode->width, mode->height, mode->refreshRate);
}

} // namespace lumel
