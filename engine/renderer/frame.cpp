// recordFrame() is the frame: read it first.
#include "frame.h"
#include "core/error.h"
#include "core/math.h"
#include "core/progress.h"
#include "resources/culling.h"
#include "setting_table.h"
#include <chrono>

namespace lumel {

void Renderer::recordFrame(Frame& frame)
{
    settled_ = true;
    deform_.record(frame); // joints and morph targets move vertices
    shadow_.record(frame); // how far the lights reach, where lights or objects have moved
    if (settings_.shading == Shading::tsl)
        recordTextureSpace(frame);
    if (settings_.shading == Shading::reference)
        recordReference(frame); // ground truth: many jittered forward frames at level 0
    else
        draw_.record(frame, pool_); // look the light up, per pixel
    endPass(frame);
    // Tone-map, once, and smooth the staircases between objects.
    display_.record(frame, settings_.shading == Shading::reference ? sumSamples_ : 0,
                    filtersEdges(settings_) ? &edges_ : nullptr);
}

void Renderer::recordTextureSpace(Frame& frame)
{
    settled_ = isSettled(frame);
    if (settled_) {
        plan_.prepare(frame, pool_); // the objects still draw their lit textures
        return;                      // and these hold all the light that this view needs
    }
    const uint32_t spacing = sampleSpacing(frame);
    // What does this view need, and how finely? The CPU assigns memory by the answer.
    if (!frame.late)
        findFeedback(frame, spacing);
    FeedbackPass::apply(latest_, frame);
    if (frame.late)
        chooseDetail(frame);
    assignTextures(frame, spacing); // which recycled texture does each object draw?
    sampled_ = !frame.late || !feedback_.serveAgain(frame, spacing);
    if (frame.late && sampled_)
        feedback_.record(frame, spacing); // the answer is for a later frame
    pool_.recordHandovers(frame);
    plan_.record(frame, feedback_); // which of its tiles are to be lit, derived or kept?
    endPass(frame);
    light_.recordLight(frame, pool_, plan_); // light them, once: linear radiance
    endPass(frame);
    light_.recordLower(frame, pool_, plan_); // derive coarser tiles
    plan_.recordReadback(frame);             // how many?
    endPass(frame);
}

Renderer::Renderer(const gpu::Device& device, const scene::Scene& scene, const SceneResources& resources,
                   const Settings& settings)
    : device_(device), settings_(settings), targets_(device, settings), scene_(device, scene, resources),
      shadow_(device, scene_), pool_(device, settings.poolBytes), feedback_(device, settings.size, scene_),
      plan_(device, scene_, feedback_), light_(device, scene_, pool_), edges_(device, scene_, targets_),
      display_(device, targets_), sceneRadius_(scene.bounds.radius()), ring_(device)
{
    for (auto& own : inFlight_)
        own = std::make_unique<InFlight>(device);
    if (settings.budgetMs > 0.0)
        budget_.emplace(settings.budgetMs);
    preparePipelines();
}

Renderer::Renderer(const gpu::Device& device, const scene::Scene& scene,
                   const std::vector<scene::BakedMaterial>& materials, const Settings& settings)
    : Renderer(device, scene, uploadScene(device, scene, materials), settings)
{
}

void Renderer::begin(Frame& frame)
{
    frame.commands.begin(vk::CommandBufferBeginInfo{.flags = vk::CommandBufferUsageFlagBits::eOneTimeSubmit});
    frame.bound = {};
    frame.timer.reset(frame.commands);
    // What frames do not have one each of, they use one after the other.
    gpu::memoryBarrier(frame.commands, gpu::Use::general, gpu::Use::general);
}

void Renderer::submit(Frame& frame)
{
    frame.commands.end();
    own().submission = ring_.submit(frame.commands);
}

void Renderer::submitAndWait(Frame& frame)
{
    submit(frame);
    ring_.wait(own().submission);
    for (const auto& [name, ms] : frame.timer.results())
        own().stats.passMs[name] += ms;
    if (passesAlone_)
        checkInterrupted();
    begin(frame);
}

void Renderer::endPass(Frame& frame)
{
    if (passesAlone_)
        submitAndWait(frame);
}

shared::View Renderer::makeView(const Frame& frame, glm::vec2 shiftInPixels) const
{
    glm::mat4 shift(1.0f);
    shift[3][0] = 2.0f * shiftInPixels.x / float(settings_.size.x);
    shift[3][1] = 2.0f * shiftInPixels.y / float(settings_.size.y);
    shared::View view{};
    view.clipFromWorld = shift * frame.clipFromWorld;
    view.worldFromClip = glm::mat4(glm::inverse(glm::dmat4(shift * frame.clipFromWorld)));
    view.eyeInWorld = frame.eye;
    view.exposure = settings_.exposure;
    view.anisotropy = frame.detail.anisotropy;
    view.sizePixels = settings_.size;
    view.frame = frame.index;
    view.levelOffset = frame.detail.levelOffset;
    view.objects = scene_.objectTable().address();
    scene_.lights().describe(view);
    return view;
}

void Renderer::writeView(const Frame& frame)
{
    scene_.frameSet().writeView(makeView(frame));
}

FrameStats Renderer::render(const scene::Camera& camera)
{
    sumSamples_ = 0;
    return renderFrame(camera);
}

FrameStats Renderer::accumulate(const scene::Camera& camera)
{
    if (clipFromWorld(camera) != sumView_ || scene_.changed() > sumFrame_)
        sumSamples_ = 0;
    return renderFrame(camera);
}

void Renderer::restart()
{
    learnAll();
    pool_.clear(settings_.poolBytes);
    residency_ = {};
    first_ = true;
    sumSamples_ = 0;
    knownView_ = glm::mat4(0.0f);
    detail_.reset();
    offsetsSeen_ = 0;
    lumelsPending_ = 0;
    tilesMarked_ = 0;
    latest_ = {};
    plan_.surfaces().clear(ring_);
    known_ = {};
}

void Renderer::setSettings(const Settings& settings)
{
    const unsigned changed = changes(settings_, settings);
    if (changed)
        learnAll();
    const Settings before = std::exchange(settings_, settings);
    if ((changed & invalidates::targets) && !Targets::same(before, settings)) {
        targets_ = Targets(device_, settings);
        display_.connect(device_, targets_);
        edges_.connect(device_, targets_);
        floors_.reset();
    }
    if (changed & invalidates::sum)
        sumSamples_ = 0; // lumels see to it that what changed is lit again
    if (changed & invalidates::feedback) {
        feedback_.resize(device_, settings.size);
        latest_ = {};
    }
    if (changed & invalidates::budget) {
        budget_.reset();
        if (settings.budgetMs > 0.0)
            budget_.emplace(settings.budgetMs);
        quality_ = {};
        budgetMissed_ = false;
    }
    if (changed & invalidates::pool) {
        pool_.clear(settings.poolBytes);
        residency_ = {};
        latest_ = {};
    }
    if (changed & invalidates::lumels) {
        knownView_ = glm::mat4(0.0f);
        detail_.reset();
    }
    if (changed)
        preparePipelines();
}

void Renderer::setLights(const std::vector<scene::Light>& lights)
{
    scene_.lights().set(lights, frameIndex_ + 1);
    preparePipelines();
}

void Renderer::setEnvironment(std::shared_ptr<const EnvironmentMap> environment)
{
    finish();
    scene_.lights().setEnvironment(std::move(environment), frameIndex_ + 1);
    preparePipelines();
}

void Renderer::changeMaterial(size_t material)
{
    scene_.changeMaterial(material, frameIndex_ + 1);
    preparePipelines();
}

void Renderer::expectSecondLobes(const std::set<size_t>& materials)
{
    scene_.expectSecondLobes(materials);
    preparePipelines();
}

// All that frames can need, so that none waits for a driver to compile one: in the background, while whatever
// comes before the first frame that uses them runs. First what the first frame needs.
void Renderer::preparePipelines()
{
    const Frame frame = makeFrame(settings_, targets_, frameIndex_ + 1);
    const uint32_t lights = scene_.lights().features(ShadowPass::countMaps(scene_, settings_));
    deform_.prepare(frame);
    if (settings_.shadows)
        shadow_.preparePipelines(frame);
    if (settings_.shading == Shading::tsl) {
        feedback_.prepare(frame);
        light_.prepare(frame, pool_, lights);
    }
    draw_.prepare(frame, pool_, lights);
    if (filtersEdges(settings_))
        edges_.prepare(frame);
    display_.prepare(frame);
    if (settings_.shading == Shading::tsl) {
        light_.prepareCached(frame, pool_, plan_, lights);
        draw_.prepareFades(frame, pool_, lights);
    }
}

glm::mat4 Renderer::clipFromWorld(const scene::Camera& camera) const
{
    const float aspect = float(settings_.size.x) / float(settings_.size.y);
    return reversedPerspective(camera.yFov, aspect, camera.nearMetres) *
           glm::lookAt(camera.eye, camera.target, camera.up);
}

// Without a view.
Frame Renderer::makeFrame(const Settings& settings, Targets& targets, uint32_t index)
{
    return {.device = device_,
            .commands = *own().commands,
            .timer = own().timer,
            .ring = ring_,
            .scene = scene_,
            .targets = targets,
            .settings = settings,
            .renderSize = settings.size,
            .index = index,
            .place = place_,
            .inView = {},
            .feedback = {},
            .detail = detail_.value_or(tsl::Detail{settings_.levelOffset, settings_.anisotropy}),
            .lumelBudget = settings.lumelBudget,
            .residency = residency_};
}

// With the scene made ready for it. `settings` and `targets` may be others than the renderer's.
Frame Renderer::makeFrame(const scene::Camera& camera, const Settings& settings, Targets& targets,
                          uint32_t index)
{
    Frame frame = makeFrame(settings, targets, index);
    frame.clipFromWorld = clipFromWorld(camera);
    frame.eye = camera.eye;
    scene_.lights().adjustAmbient(settings_.ambient, index);
    scene_.lights().adjustEnvironment(settings_.environmentIntensity, settings_.environmentRotation, index);
    shadow_.prepare(frame);
    frame.inView = objectsInView(scene_.objects(), frame.clipFromWorld);
    scene_.begin(place_);
    scene_.writeObjects();
    scene_.lights().writeTable();
    return frame;
}

FrameStats Renderer::renderFrame(const scene::Camera& camera)
{
    if (interrupted())
        throw Interrupted();
    const BusyClock::Running runs(clock_);
    const gpu::HostWork before = gpu::hostWork();
    place_ = ++frameIndex_ % places();
    InFlight& own = *inFlight_[place_];
    ring_.waitForPlace(own.submission);
    read(own);
    learn(own);
    const bool late = isLate(camera);
    if (!late)
        learnAll();
    own.begunMs = clock_.ms();
    own.stats = {};
    if (budget_)
        quality_ = budget_->quality();
    Frame frame = makeFrame(camera, settings_, targets_, frameIndex_);
    frame.late = late;
    frame.renderSize = glm::max(glm::uvec2(glm::round(glm::vec2(settings_.size) * quality_.renderScale)), 1u);
    frame.detail.levelOffset += quality_.levelBias;
    frame.lumelBudget = std::min(settings_.lumelBudget, quality_.lumels);
    renderSize_ = frame.renderSize;
    if (budget_ && settings_.shading == Shading::tsl)
        noteDynamic(frame);
    writeView(frame);
    if (sumSamples_ == 0)
        sumFrame_ = frameIndex_;
    sumView_ = frame.clipFromWorld;
    begin(frame);
    recordFrame(frame);
    submit(frame);
    if (!late)
        ring_.wait(own.submission);
    first_ = first_ && settings_.shading != Shading::tsl;
    lastCamera_ = camera;
    inView_ = frame.inView;
    countFrame(frame, own);
    own.stats.hostWork = gpu::hostWork() - before;
    if (!late)
        learnAll();
    return last_;
}

} // namespace lumel
