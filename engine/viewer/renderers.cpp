#include "renderers.h"
#include "core/compare.h"
#include "core/error.h"
#include "renderer/setting_table.h"

namespace lumel {
namespace {

// After the last change of a view, until it is rendered without a budget: longer than the pauses of a hand
// that drags.
constexpr auto kStill = std::chrono::milliseconds(200);

} // namespace

bool sameCamera(const scene::Camera& a, const scene::Camera& b)
{
    return a.eye == b.eye && a.target == b.target && a.up == b.up && a.yFov == b.yFov &&
           a.nearMetres == b.nearMetres;
}

bool sameView(const ui::ViewState& a, const ui::ViewState& b)
{
    return sameCamera(a.camera.camera(), b.camera.camera()) && changes(a.settings, b.settings) == 0 &&
           a.settings.size == b.settings.size && a.sides == b.sides && a.split == b.split &&
           a.seconds == b.seconds && a.lightsEdited == b.lightsEdited && a.continuous == b.continuous &&
           (!a.lightsEdited || a.lights == b.lights);
}

ViewRenderers::Slot* ViewRenderers::rendererOf(size_t side)
{
    return &slots_[isReference_[side] ? kReference : side];
}

const ViewRenderers::Slot* ViewRenderers::rendererOf(size_t side) const
{
    return &slots_[isReference_[side] ? kReference : side];
}

void ViewRenderers::setScene(scene::LoadedScene loaded, const ui::ViewState& state)
{
    // Built beside the old renderers, so that these stay as they are when memory runs out.
    Settings settings = state.settings;
    settings.shading = Shading::forward;
    const SceneResources resources = uploadScene(device_, *loaded.scene, *loaded.materials);
    Slot first{.renderer = std::make_unique<Renderer>(device_, *loaded.scene, resources, settings),
               .method = loaded.options.method,
               .exact = {},
               .exactSeconds = {},
               .isFirst = true,
               .changed = {},
               .metered = {},
               .camera = {},
               .seconds = {},
               .stats = {}};
    slots_ = {};
    slots_[0] = std::move(first);
    scene_ = loaded.scene;
    playback_.reset();
    if (scene_->animation.seconds > 0.0)
        playback_.emplace(*scene_, scene::Camera{}, PathOptions{});
    geometry_ = resources.geometry;
    {
        const std::lock_guard lock(materialsMutex_);
        materials_ = {{loaded.options.method,
                       {.baked = loaded.materials,
                        .placeholders = loaded.placeholders,
                        .options = loaded.options,
                        .uploaded = resources.materials}}};
    }
    environment_ = resources.environment;
    lights_.reset();
}

void ViewRenderers::restart(Slot& slot)
{
    slot.renderer.reset();
    slot.exact.reset();
    slot.rendered = slot.isExact = false;
}

void ViewRenderers::restart()
{
    for (Slot& slot : slots_)
        restart(slot);
}

void ViewRenderers::prepare(Slot& slot, const ui::ViewState& state, baker::Method method,
                            const Settings& settings)
{
    if (!slot.renderer || slot.method != method) {
        slot = {};
        slot.renderer = std::make_unique<Renderer>(device_, *scene_, resourcesOf(method), settings);
        slot.method = method;
        if (lights_)
            slot.renderer->setLights(*lights_);
    }
    if (playback_ && state.seconds && slot.seconds != state.seconds) {
        playback_->pose(*slot.renderer, *state.seconds);
        if (lights_) // edited lights stay where they are
            slot.renderer->setLights(*lights_);
        slot.seconds = state.seconds;
        slot.rendered = false;
        slot.metered.reset();
    }
    if (std::exchange(slot.stale, false))
        slot.rendered = false;
    const unsigned changed = changes(slot.renderer->settings(), settings);
    const bool moved = !sameCamera(slot.camera, state.camera.camera());
    if (moved || (changed & ~unsigned(invalidates::display)))
        slot.metered.reset();
    if (moved || changed)
        slot.rendered = false;
    slot.renderer->setSettings(settings);
    slot.camera = state.camera.camera();
}

// False when the picture is up to date.
bool ViewRenderers::renderSlot(Slot& slot, const ui::ViewState& state, ProgressMonitor& stop)
{
    slot.refined = false;
    Renderer& renderer = *slot.renderer;
    const bool reference = renderer.settings().shading == Shading::reference;
    const bool done = reference ? renderer.samples() >= state.settings.samples : isDone(slot);
    const bool again = state.continuous && !reference;
    if (slot.rendered && done && !again)
        return false;
    const auto now = std::chrono::steady_clock::now();
    if (!slot.rendered)
        slot.changed = now;
    if (slot.rendered && !reference && renderer.settings().budgetMs > 0.0 && !again) {
        if (now - slot.changed >= kStill)
            return slot.refined = renderExact(slot, state, &stop);
        if (renderer.settled())
            return false;
    }
    forgetExact(slot);
    slot.isFirst = false;
    slot.stats = reference ? renderer.accumulate(slot.camera) : renderer.render(slot.camera);
    slot.rendered = true;
    return true;
}

bool ViewRenderers::isDone(const Slot& slot) const
{
    if (!slot.renderer || !slot.rendered)
        return false;
    return slot.renderer->settings().budgetMs > 0.0 ? slot.isExact : slot.renderer->settled();
}

bool ViewRenderers::renderExact(Slot& slot, const ui::ViewState& state, ProgressMonitor* stop)
{
    Settings settings = slot.renderer->settings();
    settings.budgetMs = 0.0;
    settings.residency = ResidencyFrom::exact;
    if (!slot.exact) {
        slot.exact = std::make_unique<Renderer>(device_, *scene_, resourcesOf(slot.method), settings);
        slot.exact->submitPassesAlone();
        if (lights_)
            slot.exact->setLights(*lights_);
    }
    if (playback_ && state.seconds && slot.exactSeconds != state.seconds) {
        playback_->pose(*slot.exact, *state.seconds);
        if (lights_)
            slot.exact->setLights(*lights_);
        slot.exactSeconds = state.seconds;
    }
    slot.exact->setSettings(settings);
    slot.exact->restart();
    monitorThisThread(stop);
    try {
        slot.stats = slot.exact->render(slot.camera);
        slot.isExact = true;
    } catch (const Interrupted&) {
        slot.exact->restart();
        if (interrupted())
            throw;
    }
    monitorThisThread(nullptr);
    return slot.isExact;
}

// While the view moves, its memory is free.
void ViewRenderers::forgetExact(Slot& slot)
{
    if (std::exchange(slot.isExact, false))
        slot.exact->restart();
}

template<class Change>
void ViewRenderers::changeAll(const Change& change)
{
    for (Slot& slot : slots_) {
        if (slot.exact)
            change(*slot.exact);
        if (!slot.renderer)
            continue;
        change(*slot.renderer);
        slot.rendered = false;
        slot.metered.reset();
    }
}

void ViewRenderers::setLights(const std::vector<scene::Light>& lights)
{
    lights_ = lights;
    changeAll([&](Renderer& renderer) { renderer.setLights(lights); });
}

void ViewRenderers::setEnvironment(std::shared_ptr<const scene::Environment> environment)
{
    environment_ = std::make_shared<const EnvironmentMap>(device_, environment.get());
    changeAll([&](Renderer& renderer) { renderer.setEnvironment(environment_); });
}

std::vector<tsl::ObjectResidency> ViewRenderers::residency(size_t side) const
{
    const Slot* slot = rendererOf(side);
    const bool lit = slot->renderer && slot->renderer->settings().shading == Shading::tsl;
    return lit ? shown(*slot).residency().objects() : std::vector<tsl::ObjectResidency>();
}

std::vector<glm::uvec2> ViewRenderers::lumelGrids() const
{
    std::vector<glm::uvec2> grids;
    for (const GpuObject& object : slots_[0].renderer->scene().objects())
        grids.push_back(object.data.litSize);
    return grids;
}

float ViewRenderers::ambient() const
{
    for (const Slot& slot : slots_) // alike in all
        if (slot.renderer)
            return slot.renderer->scene().lights().skyRadiance().x;
    return 0.0f;
}

ViewRenderers::Slot& ViewRenderers::prepareSide(const ui::ViewState& state, glm::uvec2 size, size_t i)
{
    const ui::Side& side = state.sides[i];
    isReference_[i] = side.shading == Shading::reference;
    if (isReference_[i])
        return prepareReference(state, size);
    Settings settings = state.settings;
    settings.size = size;
    Slot& slot = slots_[i];
    // The pipelines of plain forward shading are few: where all are still to be compiled, it is there sooner.
    const bool soon = slot.isFirst && side.shading == Shading::tsl && settings.budgetMs > 0.0;
    settings.shading = soon ? Shading::forward : side.shading;
    settings.edgeFilter = settings.edgeFilter && !soon;
    if (materials(side.filter)) // else the old ones, until these are baked
        prepare(slot, state, side.filter, settings);
    else if (slot.renderer)
        prepare(slot, state, slot.method, settings);
    else
        prepare(slot, state, materials_.begin()->first, settings);
    return slot;
}

ViewRenderers::Slot& ViewRenderers::prepareReference(const ui::ViewState& state, glm::uvec2 size)
{
    Slot& slot = slots_[kReference];
    Settings settings = state.settings;
    settings.size = size;
    settings.shading = Shading::reference;
    settings.samples = 1; // per frame
    prepare(slot, state, slot.renderer ? slot.method : materials_.begin()->first, applicable(settings));
    return slot;
}

std::optional<LuminanceHistogram> ViewRenderers::meter(const ui::ViewState& state, glm::uvec2 size)
{
    if (!scene_)
        return std::nullopt;
    if (lights_ != state.lights && state.lightsEdited)
        setLights(state.lights);
    Slot& slot = prepareSide(state, size, 0);
    if (!slot.metered)
        slot.metered = slot.renderer->meter(slot.camera);
    return slot.metered;
}

bool ViewRenderers::render(const ui::ViewState& state, glm::uvec2 size, SceneReport& report,
                           ProgressMonitor& stop)
{
    if (!scene_)
        return false;
    if (lights_ != state.lights && state.lightsEdited)
        setLights(state.lights);
    const size_t sides = state.split ? 2 : 1;
    bool rendered = false, settled = true, needsReference = false;
    for (size_t i = 0; i < sides; ++i) {
        Slot& slot = prepareSide(state, size, i);
        needsReference = needsReference || isReference_[i];
        if (isReference_[i])
            continue;
        rendered = renderSlot(slot, state, stop) || rendered;
        expectSecondLobes(slot, state.sides[i].shading);
        settled = settled && isDone(slot);
        report.sides[i].stats = slot.stats;
    }
    // Both sides are compared with the reference once they are done.
    if (needsReference || (state.split && settled)) {
        Slot& slot = prepareReference(state, size);
        rendered = renderSlot(slot, state, stop) || rendered;
        settled = settled && slot.renderer->samples() >= state.settings.samples;
        for (size_t i = 0; i < sides; ++i)
            if (isReference_[i]) {
                report.sides[i].stats = slot.stats;
                report.sides[i].samples = slot.renderer->samples();
            }
    }
    finished_ = settled && !state.continuous;
    forgetUnused(state);
    for (size_t i = 0; i < sides; ++i)
        report.methods[i] = method(i);
    if (rendered)
        measure(state, report);
    return rendered;
}

void ViewRenderers::measure(const ui::ViewState& state, SceneReport& report)
{
    const Slot& reference = slots_[kReference];
    const int samples =
        state.split && reference.renderer && reference.rendered ? reference.renderer->samples() : 0;
    const bool current = samples > 0 && sameCamera(reference.camera, state.camera.camera());
    if (!current || samples < measuredSamples_ || state.settings.view != View::none) {
        report.sides[0].psnr.reset();
        report.sides[1].psnr.reset();
        report.referenceSamples = measuredSamples_ = 0;
    }
    // Reading pictures back takes time: whenever the number of samples has doubled.
    const bool worthwhile = samples >= std::min(2 * measuredSamples_, state.settings.samples);
    if (!current || !worthwhile || samples == measuredSamples_ || state.settings.view != View::none)
        return;
    const Image groundTruth = reference.renderer->readDisplay();
    for (size_t i = 0; i < 2; ++i)
        if (!isReference_[i] && slots_[i].renderer)
            report.sides[i].psnr = compareQuickly(shown(slots_[i]).readDisplay(), groundTruth).psnr;
    report.referenceSamples = measuredSamples_ = samples;
}

Renderer* ViewRenderers::shown(size_t side)
{
    const Slot* slot = rendererOf(side);
    return slot->rendered ? &shown(*slot) : nullptr;
}

Image ViewRenderers::screenshot(const ui::ViewState& state, size_t side, bool radiance)
{
    prepareSide(state, state.settings.size, side);
    Slot& slot = *rendererOf(side);
    // Lumels kept from other views are within the tolerance, not the same, and a budget's quality depends on
    // the machine's load.
    const bool isShown = slot.isExact && slot.rendered;
    if (isReference_[side])
        slot.rendered = true;
    else if (!isShown)
        renderExact(slot, state, nullptr);
    Image picture = radiance ? shown(slot).readRadiance() : shown(slot).readDisplay();
    slot.isExact = isShown; // else the window does not have it yet
    return picture;
}

} // namespace lumel
