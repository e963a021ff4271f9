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
        if (!scene_)
            return;
        actOnCamera(asked, layout);
        if (state_.lightsEdited)
            for (scene::Light& light : state_.lights)
                light = scene::parseLight(scene::lightText(light)); // what the command's options say
        if (asked.copyCommand)
            copyCommand();
        if (asked.screenshotPng)
            waiting_.emplace_back(".png", state_);
        if (asked.screenshotExr)
            waiting_.emplace_back(".exr", state_);
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
    const auto scene = scene_;
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
    const auto scene = scene_;
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
    load_ = {.kind = Load::Kind::material,
             .file = file,
             .material = material.name,
             .method = state_.sides[0].filter};
    loader_.begin(arguments_.scene, bakeOptions(load_.method), changed);
}

// Of the command that renders what a side shows.
static SceneArguments argumentsOf(size_t side, const ViewRenderers& renderers, const SceneArguments& given,
                                  const ui::ViewState& state)
{
    SceneArguments a = given;
    a.settings = renderers.settings(side);
    a.settings.shading = state.sides[side].shading; // its first frame may have been another
    a.settings.edgeFilter = state.settings.edgeFilter;
    a.settings.budgetMs = 0.0; // its quality depends on the machine's load
    a.settings.residency = ResidencyFrom::exact;
    a.settings.framesInFlight = Settings().framesInFlight;
    if (a.settings.shading == Shading::reference)
        a.settings.samples = renderers.samples(side);
    a.filter = renderers.method(side);
    a.asked.method = given.asked.method || a.filter != given.filter;
    if (state.lightsEdited) {
        a.lights = 0;
        a.lightList = state.lights;
    }
    // What the command would choose by itself depends on the view.
    const bool chooses = state.autoExposure || hasOwnLights(a, *renderers.scene());
    a.exposure = chooses || state.exposureChosen ? ExposureChoice::fixed : ExposureChoice::perScene;
    return a;
}

// Does `work`, which may throw Error, with the renderers, and says so or calls the answer.
void Viewer::ask(std::function<SceneThread::Answer(ViewRenderers&)> work)
{
    thread_->ask([this, work = std::move(work)](ViewRenderers& renderers) -> SceneThread::Answer {
        try {
            return work(renderers);
        } catch (const Interrupted&) {
            throw;
        } catch (const Error& e) {
            return [this, why = std::string(e.what())] { say(why, true); };
        }
    });
}

void Viewer::copyCommand()
{
    ask([this, state = state_, given = SceneArguments(arguments_)](ViewRenderers& renderers) {
        std::string text;
        for (size_t side = 0; side < (state.split ? 2u : 1u); ++side) {
            if (!renderers.shown(side))
                throw Error("nothing has been rendered yet; try again");
            const char* const name = !state.split ? "lumel.png"
                                     : side == 0  ? "lumel-left.png"
                                                  : "lumel-right.png";
            text +=
                shotCommand(argumentsOf(side, renderers, given, state), state.camera, state.seconds, name) +
                "\n";
        }
        return [this, text] {
            glfwSetClipboardString(frontend_.window, text.c_str());
            say("copied: " + text.substr(0, text.size() - 1));
        };
    });
}

// Their commands render what the baker makes, not what stands in for it.
void Viewer::takeWaitingScreenshots()
{
    if (!scene_ || uploading_)
        return;
    for (auto waiting = waiting_.begin(); waiting != waiting_.end();) {
        const auto [extension, state] = *waiting;
        if (thread_->missing(state) || thread_->unfinished(state)) {
            ++waiting;
            continue;
        }
        waiting = waiting_.erase(waiting);
        takeScreenshot(extension, state);
    }
}

void Viewer::takeScreenshot(const char* extension, const ui::ViewState& state)
{
    std::string stem;
    do
        stem = fmt::format("lumel-{:03}", ++screenshots_);
    while (std::filesystem::exists(stem + ".txt"));
    ask([this, stem, extension = std::string(extension), state,
         given = SceneArguments(arguments_)](ViewRenderers& renderers) {
        std::string commands, names;
        for (size_t side = 0; side < (state.split ? 2u : 1u); ++side) {
            if (!renderers.shown(side))
                throw Error("nothing has been rendered yet; try again");
            const char* const suffix = !state.split ? "" : side == 0 ? "-left" : "-right";
            const std::filesystem::path file = stem + suffix + extension;
            writeImage(file, renderers.screenshot(state, side, extension == ".exr"));
            commands +=
                shotCommand(argumentsOf(side, renderers, given, state), state.camera, state.seconds, file) +
                "\n";
            names += (names.empty() ? "" : ", ") + file.string();
        }
        writeFileAtomically(stem + ".txt", commands);
        return [this, names, stem] { say(fmt::format("saved {}, and the command in {}.txt", names, stem)); };
    });
}

void Viewer::reloadShaders()
{
    thread_->withRenderers([](ViewRenderers& renderers) {
        gpu::reloadShaders();
        renderers.restart();
    });
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
