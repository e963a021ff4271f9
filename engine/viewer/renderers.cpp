#include "renderers.h"
#include "core/compare.h"

namespace lumel {
namespace {

bool sameCamera(const scene::Camera& a, const scene::Camera& b)
{
    return a.eye == b.eye && a.target == b.target && a.up == b.up && a.yFov == b.yFov &&
           a.nearMetres == b.nearMetres;
}

// Whether the picture depends on what differs.
bool sameSettings(const Settings& a, const Settings& b)
{
    const auto all = [](const Settings& s) {
        return std::tuple(s.view, s.shading, s.size, s.filter, s.anisotropy, s.msaa, s.exposure, s.toneMap,
                          s.poolBytes, s.levelOffset, s.lumelsPerPixel, s.lumelBudget, s.refreshShare,
                          s.tolerance, s.budgetMs, s.environmentIntensity, s.environmentRotation, s.ambient,
                          s.shadows, s.shadowSize);
    };
    return all(a) == all(b);
}

// Whether the radiance does.
bool sameRadiance(Settings a, const Settings& b)
{
    a.exposure = b.exposure;
    a.toneMap = b.toneMap;
    return sameSettings(a, b);
}

} // namespace

ViewRenderers::Slot* ViewRenderers::rendererOf(size_t side)
{
    return &slots_[isReference_[side] ? kReference : side];
}

const ViewRenderers::Slot* ViewRenderers::rendererOf(size_t side) const
{
    return &slots_[isReference_[side] ? kReference : side];
}

std::shared_ptr<const std::vector<scene::BakedMaterial>> ViewRenderers::materials(baker::Method method) const
{
    const auto found = materials_.find(method);
    return found == materials_.end() ? nullptr : found->second.baked;
}

SceneResources ViewRenderers::resourcesOf(baker::Method method)
{
    Bake& bake = materials_.at(method);
    if (!bake.uploaded)
        bake.uploaded = std::make_shared<const MaterialResources>(device_, *scene_, *bake.baked);
    return {.geometry = geometry_, .materials = bake.uploaded, .environment = environment_};
}

void ViewRenderers::setScene(scene::LoadedScene loaded, const ui::ViewState& state)
{
    // Built beside the old renderers, so that a scene without room leaves these as they are.
    Settings settings = state.settings;
    settings.shading = Shading::forward;
    const SceneResources resources = uploadScene(device_, *loaded.scene, *loaded.materials);
    Slot first{.renderer = std::make_unique<Renderer>(device_, *loaded.scene, resources, settings),
               .method = loaded.options.method,
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
    materials_ = {{loaded.options.method, {.baked = loaded.materials, .uploaded = resources.materials}}};
    environment_ = resources.environment;
    lights_.reset();
}

void ViewRenderers::restart()
{
    for (Slot& slot : slots_) {
        slot.renderer.reset();
        slot.rendered = false;
    }
}

std::optional<baker::Method> ViewRenderers::missing(const ui::ViewState& state) const
{
    for (size_t side = 0; side < (state.split ? 2u : 1u); ++side)
        if (state.sides[side].shading != Shading::reference && !materials(state.sides[side].filter))
            return state.sides[side].filter;
    return std::nullopt;
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
        if (lights_) // lights put where they are by hand stay there
            slot.renderer->setLights(*lights_);
        slot.seconds = state.seconds;
        slot.rendered = false;
        slot.metered.reset();
    }
    if (!sameRadiance(slot.renderer->settings(), settings) || !sameCamera(slot.camera, state.camera.camera()))
        slot.metered.reset();
    if (!sameSettings(slot.renderer->settings(), settings) || !sameCamera(slot.camera, state.camera.camera()))
        slot.rendered = false;
    slot.renderer->setSettings(settings);
    slot.camera = state.camera.camera();
}

// False when the picture is there already.
bool ViewRenderers::renderSlot(Slot& slot, const ui::ViewState& state)
{
    Renderer& renderer = *slot.renderer;
    const bool reference = renderer.settings().shading == Shading::reference;
    const bool enough = reference ? renderer.samples() >= state.settings.samples : renderer.settled();
    if (slot.rendered && enough && !state.continuous)
        return false;
    if (reference && slot.rendered && enough)
        return false;
    slot.stats = reference ? renderer.accumulate(slot.camera) : renderer.render(slot.camera);
    slot.rendered = true;
    return true;
}

void ViewRenderers::setLights(const std::vector<scene::Light>& lights)
{
    lights_ = lights;
    for (Slot& slot : slots_)
        if (slot.renderer) {
            slot.renderer->setLights(lights);
            slot.rendered = false;
            slot.metered.reset();
        }
}

void ViewRenderers::setEnvironment(std::shared_ptr<const scene::Environment> environment)
{
    environment_ = std::make_shared<const EnvironmentMap>(device_, environment.get());
    for (Slot& slot : slots_)
        if (slot.renderer) {
            slot.renderer->setEnvironment(environment_);
            slot.rendered = false;
            slot.metered.reset();
        }
}

std::vector<tsl::ObjectResidency> ViewRenderers::residency(size_t side) const
{
    const Slot* slot = rendererOf(side);
    const bool lit = slot->renderer && slot->renderer->settings().shading == Shading::tsl;
    return lit ? slot->renderer->residency().objects() : std::vector<tsl::ObjectResidency>();
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
    settings.shading = side.shading;
    Slot& slot = slots_[i];
    if (materials(side.filter)) // else the old one, until they are there
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
    settings.samples = 1;
    settings.budgetMs = 0.0; // the reference takes its time
    prepare(slot, state, slot.renderer ? slot.method : materials_.begin()->first, settings);
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

bool ViewRenderers::render(const ui::ViewState& state, glm::uvec2 size, ui::ViewReport& report)
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
        rendered = renderSlot(slot, state) || rendered;
        settled = settled && slot.renderer->settled();
        report.sides[i].stats = slot.stats;
    }
    // Both sides are measured once they are done: then there is time for the reference.
    if (needsReference || (state.split && settled)) {
        Slot& slot = prepareReference(state, size);
        rendered = renderSlot(slot, state) || rendered;
        settled = settled && slot.renderer->samples() >= state.settings.samples;
        for (size_t i = 0; i < sides; ++i)
            if (isReference_[i]) {
                report.sides[i].stats = slot.stats;
                report.sides[i].samples = slot.renderer->samples();
            }
    }
    finished_ = settled && !state.continuous;
    forgetUnused(state);
    if (rendered)
        measure(state, report);
    return rendered;
}

// The cache has them too, and chains take a hundred MiB a material.
void ViewRenderers::forgetUnused(const ui::ViewState& state)
{
    const auto used = [&](baker::Method method) {
        for (size_t side = 0; side < (state.split ? 2u : 1u); ++side)
            if (state.sides[side].filter == method || slots_[side].method == method)
                return true;
        return false;
    };
    if (!missing(state))
        std::erase_if(materials_, [&](const auto& entry) { return !used(entry.first); });
    if (!state.split)
        slots_[1] = {};
    if (!state.split && !isReference_[0])
        slots_[kReference] = {};
}

void ViewRenderers::measure(const ui::ViewState& state, ui::ViewReport& report)
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
    // Reading pictures back takes time: as often as the reference's noise has halved.
    const bool worthwhile = samples >= std::min(2 * measuredSamples_, state.settings.samples);
    if (!current || !worthwhile || samples == measuredSamples_ || state.settings.view != View::none)
        return;
    const Image expected = reference.renderer->readDisplay();
    for (size_t i = 0; i < 2; ++i)
        if (!isReference_[i] && slots_[i].renderer)
            report.sides[i].psnr = compareQuickly(slots_[i].renderer->readDisplay(), expected).psnr;
    report.referenceSamples = measuredSamples_ = samples;
}

const gpu::Image* ViewRenderers::picture(size_t side) const
{
    const Slot* slot = rendererOf(side);
    return slot->rendered ? &slot->renderer->display() : nullptr;
}

Image ViewRenderers::screenshot(const ui::ViewState& state, size_t side, bool radiance)
{
    Slot& slot = *rendererOf(side);
    if (!isReference_[side]) {
        // Lumels kept from other views are within the tolerance, not the same.
        // A budget's quality depends on the machine's load: pictures are taken without.
        Settings settings = slot.renderer->settings();
        settings.budgetMs = 0.0;
        slot.renderer->setSettings(settings);
        slot.rendered = false;
        slot.renderer->restart();
        slot.stats = slot.renderer->render(state.camera.camera());
    }
    slot.rendered = true;
    return radiance ? slot.renderer->readRadiance() : slot.renderer->readDisplay();
}

} // namespace lumel
