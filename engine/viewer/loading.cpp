// Scenes, materials and environments: begun in the background, shown once they are there.
#include "app/setup.h"
#include "core/error.h"
#include "scene/environment.h"
#include "viewer.h"
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>

namespace lumel {

scene::MaterialOptions Viewer::bakeOptions(baker::Method method) const
{
    return {.method = method,
            .model = arguments_.model,
            .useCache = arguments_.useCache,
            .threads = arguments_.threads};
}

void Viewer::beginLoading(const std::filesystem::path& file)
{
    load_ = {.kind = Load::Kind::scene, .file = file, .material = {}};
    const bool first = !renderers_ || !renderers_->scene();
    asked_ = first ? 0.0 : glfwGetTime(); // it counts from the program's start
    loader_.begin(file, bakeOptions(state_.sides[0].filter), {}, [this, file, first](scene::Scene& scene) {
        // Options that change a scene are about the one they came with.
        if (first)
            changeScene(arguments_, scene);
        else
            scene.environment = scene::chooseEnvironment("", scene);
    });
}

void Viewer::finishLoading()
{
    report_.loading = loader_.busy() ? loader_.progress().label() : std::string();
    report_.loadingShare = loader_.progress().share();
    try {
        if (const auto loaded = loader_.take())
            take(*loaded);
    } catch (const Error& e) {
        if (!renderers_->scene())
            throw;
        if (load_.kind == Load::Kind::filter) // not to be tried again and again
            state_.sides = {ui::Side{state_.sides[0].shading, renderers_->method(0)},
                            ui::Side{state_.sides[1].shading, renderers_->method(0)}};
        say(e.what(), true);
    }
}

void Viewer::take(const scene::LoadedScene& loaded)
{
    if (load_.kind == Load::Kind::filter) {
        renderers_->addMaterials(loaded);
        return;
    }
    const bool first = !renderers_->scene();
    renderers_->setScene(loaded, state_);
    report_.scene = renderers_->scene().get();
    report_.lumelGrids = renderers_->lumelGrids();
    report_.inspection = {};
    report_.residency.clear();
    if (load_.kind == Load::Kind::material)
        keepView();
    else
        beginView(first);
}

// The scene that was shown before, with another material.
void Viewer::keepView()
{
    renderers_->setEnvironment(environment_);
    if (!state_.lightsEdited)
        renderers_->setLights(state_.lights);
    arguments_.materialFiles.emplace_back(load_.material, load_.file);
    say(fmt::format("{}: replaces the material '{}'", load_.file.filename().string(), load_.material));
}

// Another scene. first: the one that the command line's options are about.
void Viewer::beginView(bool first)
{
    arguments_.scene = load_.file;
    if (!first)
        forgetSceneOptions();
    state_.lightsEdited = false;
    state_.selected.reset();
    const scene::Scene& scene = *renderers_->scene();
    const bool animated = scene.animation.seconds > 0.0;
    state_.seconds = first && animated ? arguments_.seconds : std::nullopt;
    state_.playing = animated && !state_.seconds;
    played_ = state_.seconds.value_or(0.0);
    environment_ = scene.environment;
    state_.environment = !arguments_.environment.empty() ? arguments_.environment
                         : environment_                  ? "sky"
                                                         : "none";
    environmentName_ = state_.environment;
    if (!state_.exposureChosen) {
        state_.settings.exposure = 1.0f;
        state_.autoExposure = false;
        exposureAsked_ = hasOwnLights(arguments_, scene);
    }
    adaptation_.reset();
    resetView();
}

void Viewer::forgetSceneOptions()
{
    arguments_.camera.clear();
    arguments_.eye.reset();
    arguments_.target.reset();
    arguments_.lights = 0;
    arguments_.lightList.clear();
    arguments_.environment.clear();
    arguments_.materialFiles.clear();
    state_.settings.ambient.reset();
}

std::vector<scene::Light> Viewer::defaultLights() const
{
    const scene::Scene& scene = *renderers_->scene();
    return scene.lights.empty() ? scene::lightsOf(environment_.get()) : scene.lights;
}

void Viewer::changeEnvironment()
{
    if (!renderers_->scene() || state_.environment == environmentName_)
        return;
    try {
        environment_ = scene::chooseEnvironment(state_.environment, *renderers_->scene());
    } catch (const Error& e) {
        state_.environment = environmentName_;
        say(e.what(), true);
        return;
    }
    environmentName_ = arguments_.environment = state_.environment;
    if (state_.environment == "none" && !state_.settings.ambient) // as for --environment none
        state_.settings.ambient = 0.0f;
    renderers_->setEnvironment(environment_);
    if (state_.lightsEdited)
        return;
    state_.lights = defaultLights();
    renderers_->setLights(state_.lights);
}

void Viewer::resetView()
{
    const scene::Scene& scene = *renderers_->scene();
    arguments_.settings.size = state_.settings.size; // of the picture, which frames the scene
    const ChosenCamera chosen = chooseCamera(arguments_, scene);
    state_.camera.reset(chosen.camera, scene.bounds, !chosen.named);
    state_.lights = defaultLights();
    if (std::exchange(state_.lightsEdited, false))
        renderers_->setLights(state_.lights);
}

void Viewer::loadMissing()
{
    if (loader_.busy() || !renderers_->scene())
        return;
    if (const auto method = renderers_->missing(state_)) {
        load_ = {.kind = Load::Kind::filter, .file = {}, .material = {}};
        loader_.begin(arguments_.scene, bakeOptions(*method), renderers_->scene());
    }
}

} // namespace lumel
