// Scenes, materials and environments: begun in the background, shown once they are there.
#include "app/setup.h"
#include "core/error.h"
#include "scene/environment.h"
#include "viewer.h"
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

namespace lumel {

scene::MaterialOptions Viewer::bakeOptions(baker::Method method) const
{
    scene::AskedBake asked = arguments_.asked;
    asked.method = asked.method || method != arguments_.filter; // chosen in a panel
    return {.method = method,
            .model = arguments_.model,
            .lobes = arguments_.lobes,
            .useCache = arguments_.useCache,
            .threads = arguments_.threads,
            .asked = asked};
}

void Viewer::beginLoading(const std::filesystem::path& file)
{
    load_ = {.kind = Load::Kind::scene, .file = file, .material = {}, .method = state_.sides[0].filter};
    const bool first = !scene_;
    asked_ = first ? 0.0 : glfwGetTime(); // it counts from the program's start
    reported_ = baking_ = false;
    loader_.begin(file, bakeOptions(load_.method), {}, [this, file, first](scene::Scene& scene) {
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
    if (uploading_) // no share of it is known
        report_.loading = "uploading " + load_.file.filename().string();
    const bool baking = loader_.baking();
    try {
        if (std::shared_ptr<scene::LoadedScene> loaded = loader_.take())
            take(loaded);
        if (!uploading_)
            takeBakes();
    } catch (const Error& e) {
        if (baking) {
            thread_->withRenderers(
                [&](ViewRenderers& renderers) { renderers.keepPlaceholders(load_.method); });
            say(e.what(), true);
        } else {
            loadFailed(load_, e.what());
        }
    }
}

// What was baked since takes the places of its placeholders.
void Viewer::takeBakes()
{
    const auto bakes = std::make_shared<const std::vector<scene::FinishedBake>>(loader_.takeBakes());
    if (!bakes->empty())
        ask([bakes, method = load_.method](ViewRenderers& renderers) {
            renderers.replace(method, *bakes);
            return [] {};
        });
    if (!std::exchange(baking_, loader_.baking()) || baking_)
        return;
    spdlog::info("{}: materials baked after {:.1f} s", arguments_.scene.string(), glfwGetTime() - asked_);
    if (hasOwnLights(arguments_, *scene_) && !state_.exposureChosen)
        meterAgain();
}

// The exposure that was chosen by placeholders is chosen by what has replaced them.
void Viewer::meterAgain()
{
    ask([this, state = state_](ViewRenderers& renderers) {
        return [this, histogram = renderers.meter(state, state.settings.size)] {
            metered_ = histogram;
            exposureAsked_ = true;
        };
    });
}

void Viewer::loadFailed(const Load& load, const std::string& why)
{
    if (!scene_)
        throw Error(why);
    if (load.kind == Load::Kind::filter) // not to be tried again and again
        state_.sides = {ui::Side{state_.sides[0].shading, report_.methods[0]},
                        ui::Side{state_.sides[1].shading, report_.methods[0]}};
    say(why, true);
}

void Viewer::take(const std::shared_ptr<scene::LoadedScene>& loaded)
{
    const Load load = load_;
    baking_ = false;
    if (load.kind == Load::Kind::filter) {
        thread_->withRenderers([&](ViewRenderers& renderers) { renderers.addMaterials(*loaded); });
        return;
    }
    uploading_ = true;
    thread_->ask([this, load, loaded, state = state_](ViewRenderers& renderers) -> SceneThread::Answer {
        try {
            if (load.kind != Load::Kind::material || !renderers.setMaterials(*loaded))
                renderers.setScene(*loaded, state);
        } catch (const Error& e) {
            return [this, load, why = std::string(e.what())] {
                uploading_ = false;
                loadFailed(load, why);
            };
        }
        return [this, load, scene = loaded->scene, grids = renderers.lumelGrids()] {
            uploading_ = false;
            report_.lumelGrids = grids;
            const bool first = !std::exchange(scene_, scene);
            taken(load, first);
        };
    });
}

void Viewer::taken(const Load& load, bool first)
{
    report_.scene = scene_.get();
    report_.inspection = {};
    report_.residency.clear();
    if (load.kind == Load::Kind::material)
        keepView(load);
    else
        beginView(load, first);
}

// The scene that was shown before, with another material.
void Viewer::keepView(const Load& load)
{
    thread_->withRenderers([&](ViewRenderers& renderers) {
        renderers.setEnvironment(environment_);
        if (!state_.lightsEdited)
            renderers.setLights(state_.lights);
    });
    arguments_.materialFiles.emplace_back(load.material, load.file);
    say(fmt::format("{}: replaces the material '{}'", load.file.filename().string(), load.material));
}

// Another scene. first: the one that the command line's options are about.
void Viewer::beginView(const Load& load, bool first)
{
    arguments_.scene = load.file;
    if (!first)
        forgetSceneOptions();
    state_.lightsEdited = false;
    state_.selected.reset();
    waiting_.clear();
    const scene::Scene& scene = *scene_;
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
    exposureKnown_ = false;
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
    const scene::Scene& scene = *scene_;
    return scene.lights.empty() ? scene::lightsOf(environment_.get()) : scene.lights;
}

void Viewer::changeEnvironment()
{
    if (!scene_ || state_.environment == environmentName_)
        return;
    try {
        environment_ = scene::chooseEnvironment(state_.environment, *scene_);
    } catch (const Error& e) {
        state_.environment = environmentName_;
        say(e.what(), true);
        return;
    }
    environmentName_ = arguments_.environment = state_.environment;
    if (state_.environment == "none" && !state_.settings.ambient) // as for --environment none
        state_.settings.ambient = 0.0f;
    if (!state_.lightsEdited)
        state_.lights = defaultLights();
    thread_->withRenderers([&](ViewRenderers& renderers) {
        renderers.setEnvironment(environment_);
        if (!state_.lightsEdited)
            renderers.setLights(state_.lights);
    });
}

void Viewer::resetView()
{
    const scene::Scene& scene = *scene_;
    arguments_.settings.size = state_.settings.size; // of the picture, which frames the scene
    const ChosenCamera chosen = chooseCamera(arguments_, scene);
    state_.camera.reset(chosen.camera, scene.bounds, !chosen.named);
    state_.lights = defaultLights();
    if (std::exchange(state_.lightsEdited, false))
        thread_->withRenderers([&](ViewRenderers& renderers) { renderers.setLights(state_.lights); });
}

void Viewer::loadMissing()
{
    if (!scene_ || uploading_ || (loader_.busy() && !loader_.baking()))
        return;
    auto method = thread_->missing(state_); // sooner than what is being baked
    if (!method && !loader_.busy())
        method = thread_->unfinished(state_);
    if (!method)
        return;
    load_ = {.kind = Load::Kind::filter, .file = {}, .material = {}, .method = *method};
    loader_.begin(arguments_.scene, bakeOptions(*method), scene_);
}

} // namespace lumel
