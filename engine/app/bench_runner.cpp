#include "bench_runner.h"
#include "bench/floors.h"
#include "bench/quality.h"
#include "core/error.h"
#include "gltf/gltf.h"
#include "renderer/setting_text.h"
#include <deque>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace lumel {
namespace {

// `count` objects spread evenly over the file's order; 0: all.
std::vector<scene::Object> spreadObjects(const std::vector<scene::Object>& all, size_t count)
{
    if (count == 0 || count >= all.size())
        return all;
    std::vector<scene::Object> some;
    for (size_t i = 0; i < count; ++i)
        some.push_back(all[i * all.size() / count]);
    return some;
}

int lightsAt(const std::vector<LoadStep>& load, int frame)
{
    int lights = load.front().lights;
    for (const LoadStep& step : load)
        if (step.frame <= frame)
            lights = step.lights;
    return lights;
}

// What one way of shading is rendered with.
SceneArguments argumentsOf(const BenchShading& shading, const SceneArguments& common)
{
    SceneArguments way = common;
    way.settings.shading = shading.shading;
    way.settings.forwardAnisotropy = shading.anisotropic ? common.settings.forwardAnisotropy : 1;
    way.filter = shading.filter.value_or(common.filter);
    if (shading.samples > 0)
        way.settings.samples = shading.samples;
    if (shading.shading == Shading::reference)
        way.settings = applicable(way.settings); // it has one quality only
    return way;
}

std::string describeLoad(const std::vector<LoadStep>& load)
{
    std::string text;
    for (const LoadStep& step : load)
        text += fmt::format("{}{}@{}", text.empty() ? "" : ",", step.lights, step.frame);
    return text;
}

} // namespace

struct BenchRunner::Run {
    Renderer renderer;
    RunInfo info;
    std::deque<int> begun; // frames in flight, the oldest first
    std::vector<FrameStats> frames;
    std::vector<bench::FloorFrame> floors; // parallel, with --floors
    Image before;                          // for flicker: the frame before

    Run(const gpu::Device& device, const scene::Scene& scene, const SceneResources& resources,
        const Settings& settings)
        : renderer(device, scene, resources, settings)
    {
    }
};

// What all runs of a scene share.
struct BenchRunner::Uploaded {
    std::shared_ptr<const GeometryResources> geometry;
    std::map<baker::Method, std::shared_ptr<MaterialResources>> materials;
    std::shared_ptr<const EnvironmentMap> environment, noEnvironment;

    SceneResources resourcesOf(baker::Method method, const scene::Scene& scene) const
    {
        return {.geometry = geometry,
                .materials = materials.at(method),
                .environment = scene.environment ? environment : noEnvironment};
    }
};

struct BenchRunner::View {
    Playback playback;
    Bounds bounds;
    std::vector<scene::Object> objects;
    int lightsNow = 0; // of the load
    std::vector<std::unique_ptr<Run>> runs;
    std::unique_ptr<Renderer> reference;
    std::map<int, Image> references; // by frame, of this turn
};

BenchRunner::BenchRunner(const gpu::Device& device, const BenchArguments& arguments)
    : device_(device), arguments_(arguments)
{
    for (const auto& file : arguments.scenes)
        addScene(file);
}

BenchRunner::~BenchRunner() = default;

bool BenchRunner::needsReference(int frame) const
{
    if (arguments_.flicker)
        return frame >= 0;
    return arguments_.errorEvery > 0 && frame >= 0 && frame % arguments_.errorEvery == 0;
}

void BenchRunner::addScene(const std::filesystem::path& file)
{
    scene::Scene scene = scene::loadGltf(file);
    SceneArguments changes = arguments_;
    changes.scene = file;
    changes.lights = 0; // below, in turn
    changeScene(changes, scene);
    const Uploaded uploaded = upload(scene);
    const std::vector<scene::Object> objects = scene.objects;
    const std::vector<scene::Light> lights = scene.lights;
    const auto environment = scene.environment;
    for (const glm::uvec2 size : arguments_.sizes)
        for (const int lightCount : arguments_.lightCounts)
            for (const int objectCount : arguments_.objectCounts) {
                BenchArguments view = arguments_;
                view.scene = file;
                view.settings.size = size;
                view.lights = arguments_.load.empty() ? lightCount : arguments_.load.front().lights;
                scene.lights = view.lights > 0 ? scene::lightRing(view.lights, scene.bounds) : lights;
                // As for `shot`: lights other than the scene's leave out the default sky.
                const bool lit = view.lights == 0 || !arguments_.environment.empty();
                scene.environment = lit ? environment : nullptr;
                scene.objects = spreadObjects(objects, size_t(objectCount));
                addView(scene, uploaded, view);
                if (objectCount > 0)
                    for (const auto& run : views_.back()->runs)
                        run->info.options["objects"] = std::to_string(scene.objects.size());
            }
}

BenchRunner::Uploaded BenchRunner::upload(const scene::Scene& scene) const
{
    Uploaded all;
    for (const BenchShading& shading : arguments_.shadings) {
        const baker::Method method = shading.filter.value_or(arguments_.filter);
        if (all.materials.contains(method))
            continue;
        scene::AskedBake asked = arguments_.asked;
        asked.method = asked.method || shading.filter;
        const std::vector<scene::BakedMaterial> baked =
            scene::bakeMaterials(scene, {.method = method,
                                         .model = arguments_.model,
                                         .lobes = arguments_.lobes,
                                         .useCache = arguments_.useCache,
                                         .threads = arguments_.threads,
                                         .quick = arguments_.quick,
                                         .asked = asked});
        all.materials[method] = std::make_shared<MaterialResources>(device_, scene, baked);
        if (!all.geometry)
            all.geometry = std::make_shared<const GeometryResources>(device_, scene, baked);
    }
    all.environment = std::make_shared<const EnvironmentMap>(device_, scene.environment.get());
    all.noEnvironment = std::make_shared<const EnvironmentMap>(device_, nullptr);
    return all;
}

void BenchRunner::addView(const scene::Scene& scene, const Uploaded& uploaded,
                          const BenchArguments& arguments)
{
    const scene::Camera camera = chooseCamera(arguments, scene).camera;
    PathOptions path = arguments.path;
    if (arguments.defaultPath)
        path.path = camera.node >= 0 ? scene::Path::animation : scene::Path::orbit;
    views_.push_back(std::unique_ptr<View>(new View{
        Playback(scene, camera, path), scene.bounds, scene.objects, arguments.lights, {}, nullptr, {}}));
    View& view = *views_.back();
    for (const BenchShading& shading : arguments_.shadings) {
        const SceneArguments way = argumentsOf(shading, arguments);
        view.runs.push_back(
            std::make_unique<Run>(device_, scene, uploaded.resourcesOf(way.filter, scene), way.settings));
        RunInfo& info = view.runs.back()->info;
        info = describeRun(way, path, camera, device_);
        info.shading = shading.name;
        info.options["warmup"] = std::to_string(arguments.warmup);
        info.options["round"] = std::to_string(arguments.round);
        if (!arguments.load.empty())
            info.options["lights"] = describeLoad(arguments.load);
    }
    // One exposure for all: that of the path's start.
    Renderer& first = view.runs.front()->renderer;
    place(view, first, 0);
    const float exposure = chooseExposure(arguments, scene, first, view.playback.camera(0));
    for (const auto& run : view.runs) {
        Settings settings = run->renderer.settings();
        settings.exposure = exposure;
        run->renderer.setSettings(settings);
        run->info.options["exposure"] = numberText(exposure);
    }
    if (arguments.errorEvery > 0 || arguments.flicker) {
        Settings settings = arguments.settings;
        settings.exposure = exposure;
        settings.shading = Shading::reference;
        view.reference = std::make_unique<Renderer>(
            device_, scene, uploaded.resourcesOf(uploaded.materials.begin()->first, scene),
            applicable(settings));
    }
}

void BenchRunner::measure()
{
    const int frames = arguments_.frames, warmup = arguments_.warmup;
    size_t runs = 0, references = 0;
    for (const auto& view : views_)
        runs += view->runs.size();
    for (int i = 0; i < frames; ++i)
        references += needsReference(i) ? views_.size() : 0;
    progress_ =
        std::make_unique<Progress>(fmt::format("{} runs", runs), runs * size_t(frames + warmup) + references);
    // The frames that lead up to the path's start count for nothing: pipelines compile, textures fill.
    for (const auto& view : views_)
        measureTurn(*view, -warmup, 0, false);
    int turn = 0;
    for (int from = 0; from < frames; from += arguments_.round, ++turn)
        for (const auto& view : views_)
            measureTurn(*view, from, std::min(from + arguments_.round, frames), turn % 2 == 1);
    progress_.reset();
}

// Every other turn runs backwards, so that none always follows the same other.
void BenchRunner::measureTurn(View& view, int from, int to, bool backwards)
{
    if (view.reference)
        renderReferences(view, from, to);
    for (size_t i = 0; i < view.runs.size(); ++i) {
        Run& run = *view.runs[backwards ? view.runs.size() - 1 - i : i];
        for (int frame = from; frame < to; ++frame)
            render(view, run, frame);
        if (to == arguments_.frames || views_.size() * view.runs.size() > 1) { // the device is another's
            run.renderer.finish();
            collect(run);
        }
    }
}

// The statistics of what has finished by now.
void BenchRunner::collect(Run& run)
{
    for (FrameStats& stats : run.renderer.takeFinished()) {
        if (run.begun.front() >= 0)
            run.frames.push_back(std::move(stats));
        run.begun.pop_front();
    }
}

void BenchRunner::renderReferences(View& view, int from, int to)
{
    const auto last = view.references.find(from - 1); // flicker needs the frame before the turn
    std::map<int, Image> kept;
    if (last != view.references.end())
        kept.insert(*last);
    view.references = std::move(kept);
    for (int frame = from; frame < to; ++frame) {
        if (!needsReference(frame))
            continue;
        place(view, *view.reference, frame);
        view.reference->render(view.playback.camera(frame));
        view.references[frame] = view.reference->readDisplay();
        progress_->advance(1);
    }
}

void BenchRunner::place(View& view, Renderer& renderer, int frame)
{
    if (!arguments_.load.empty()) {
        const int lights = lightsAt(arguments_.load, frame);
        if (lights != view.lightsNow)
            view.playback.setLights(scene::lightRing(lights, view.bounds));
        view.lightsNow = lights;
    }
    view.playback.apply(renderer, frame);
}

void BenchRunner::render(View& view, Run& run, int frame)
{
    place(view, run.renderer, frame);
    run.renderer.render(view.playback.camera(frame));
    run.begun.push_back(frame);
    const bool floors = arguments_.floors && run.renderer.settings().shading != Shading::reference;
    if (floors || (view.reference && frame >= 0))
        run.renderer.finish();
    collect(run);
    if (view.reference && frame >= 0)
        measureQuality(view, run, frame, run.frames.back());
    if (floors)
        measureFloors(view, run, frame);
    progress_->advance(1);
}

// After every frame, counted or not, so that all frames follow the same.
void BenchRunner::measureFloors(View& view, Run& run, int frame)
{
    const FloorStats floors = run.renderer.measureFloors(view.playback.camera(frame));
    if (frame < 0)
        return;
    const FrameStats& stats = run.frames.back();
    run.floors.push_back({.ms = stats.ms,
                          .passMs = stats.passMs,
                          .lit = double(stats.lumelsLit),
                          .derived = double(stats.lumelsDerived),
                          .pixels = double(floors.pixels),
                          .floorNs = floors.nanoseconds});
}

void BenchRunner::measureQuality(View& view, Run& run, int frame, FrameStats& stats) const
{
    const auto reference = view.references.find(frame);
    if (reference == view.references.end())
        return;
    Image now = run.renderer.readDisplay();
    stats.errorRmse = bench::rmseOf(now, reference->second);
    if (!arguments_.flicker)
        return;
    if (const auto before = view.references.find(frame - 1); before != view.references.end()) {
        stats.flickerRmse = bench::flickerOf(run.before, now, before->second, reference->second);
        stats.changeRmse = bench::rmseOf(before->second, reference->second);
    }
    run.before = std::move(now);
}

nlohmann::json BenchRunner::document() const
{
    nlohmann::json runs = nlohmann::json::array();
    for (const auto& view : views_)
        for (const auto& run : view->runs) {
            runs.push_back(statsJson(run->info, run->frames, objectsOf(view->objects, run->renderer),
                                     run->renderer.lumelsByTileSize()));
            if (!run->floors.empty())
                runs.back()["floors"] = bench::floorsOf(run->floors);
        }
    return {{"schema", 1}, {"version", LUMEL_VERSION}, {"runs", runs}};
}

} // namespace lumel
