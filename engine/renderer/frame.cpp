// recordFrame() is the frame: read it first.
#include "frame.h"
#include "core/error.h"
#include "core/math.h"
#include "core/progress.h"
#include "setting_table.h"
#include <chrono>
#include <spdlog/spdlog.h>

namespace lumel {

void Renderer::recordFrame(Frame& frame)
{
    settled_ = true;
    deform_.record(frame); // joints and morph targets move vertices
    shadow_.record(frame); // how far do the lights reach? Not through what has moved.
    if (settings_.shading == Shading::tsl)
        recordTextureSpace(frame);
    if (settings_.shading == Shading::reference)
        recordReference(frame); // ground truth: many jittered forward frames at level 0
    else
        draw_.record(frame, pool_); // look the light up, per pixel
    display_.record(frame, settings_.shading == Shading::reference ? sumSamples_ : 0); // tone-map, once
}

void Renderer::recordTextureSpace(Frame& frame)
{
    settled_ = isSettled(frame);
    if (settled_) {
        plan_.prepare(frame, pool_); // the objects still draw their lit textures
        return;                      // and these hold all the light that this view needs
    }
    feedback_.record(frame, first_);         // what does this view need, and how finely?
    assignTextures(frame);                   // which recycled texture does each object draw?
    plan_.record(frame, feedback_);          // which of its tiles are to be lit, derived or kept?
    light_.recordLight(frame, pool_, plan_); // light them, once: linear radiance
    light_.recordLower(frame, pool_, plan_); // derive coarser tiles
}

Renderer::Renderer(const gpu::Device& device, const scene::Scene& scene,
                   const std::vector<scene::BakedMaterial>& materials, const Settings& settings)
    : device_(device), settings_(settings), targets_(device, settings), scene_(device, scene, materials),
      shadow_(device, scene_), pool_(device, settings.poolBytes), feedback_(device, settings.size, scene_),
      plan_(device, scene_, feedback_), light_(device, scene_, pool_), display_(device, scene_, targets_),
      timer_(device),
      commands_(device.handle(), {.commandPool = *device.commandPool(), .commandBufferCount = 1})
{
    if (settings.budgetMs > 0.0)
        budget_.emplace(settings.budgetMs);
}

// Nothing to find, to light or to fade: the view has not changed since its every pixel was looked at.
bool Renderer::isSettled(const Frame& frame) const
{
    return frame.clipFromWorld == knownView_ && quality_.samePicture(knownQuality_) &&
           scene_.changed() <= knownChange_ && offsetsSeen_ >= FeedbackPass::kCycle && lumelsPending_ == 0 &&
           residency_.steady();
}

void Renderer::assignTextures(Frame& frame)
{
    // The CPU decides about memory, so it must see the feedback: the GPU waits here for a short while.
    finish(frame);
    feedback_.read(frame);
    chooseDetail(frame);
    for (tsl::ObjectFeedback& object : frame.feedback) {
        object.level += frame.detail.levelOffset;
        object.coarsest += quality_.levelBias; // within a frame budget, seams are the lesser evil
    }
    for (size_t i = 0; quality_.dynamicPerPixel && i < frame.feedback.size(); ++i)
        frame.feedback[i].dynamic = dynamicObjects_.is(i);
    residency_.assign(pool_.bookkeeping(), frame.feedback, frame.index);
    pool_.update();
    plan_.prepare(frame, pool_);
    knownFeedback_ = frame.feedback;
    known_ = {};
    for (size_t i = 0; i < frame.feedback.size(); ++i)
        if (residency_.objects()[i].texture)
            known_.pixelsCovered += frame.feedback[i].samples * feedback_.divisor() * feedback_.divisor();
    if (frame.clipFromWorld != knownView_ || !quality_.samePicture(knownQuality_))
        offsetsSeen_ = 0;
    offsetsSeen_ += feedback_.divisor() == 1 ? FeedbackPass::kCycle : 1;
    knownView_ = frame.clipFromWorld;
    knownQuality_ = quality_;
    knownChange_ = frame.index;
    begin(frame);
    pool_.recordHandovers(frame);
}

// How finely is the view to be lit? Known levels are those of the frame before's detail, which changes
// slowly; only the first detail of all takes a second look at the samples.
void Renderer::chooseDetail(Frame& frame)
{
    float pixels = 0.0f;
    for (const tsl::ObjectFeedback& object : frame.feedback)
        pixels += object.lightable ? float(object.samples) : 0.0f;
    const tsl::Detail finest{settings_.levelOffset, settings_.anisotropy};
    const bool again = !detail_;
    detail_ = tsl::detailFor(frame.elongations, pixels, finest, settings_.lumelsPerPixel, detail_);
    frame.detail = *detail_;
    frame.detail.levelOffset += quality_.levelBias;
    writeView(frame, glm::vec2(0.0f));
    if (again && *detail_ != finest) {
        begin(frame);
        feedback_.recount(frame);
        finish(frame);
        feedback_.read(frame);
    }
}

void Renderer::countLumels(const Frame& frame)
{
    if (frame.feedback.empty()) { // settled
        stats_.lumelsKept = known_.lumelsMarked;
    } else {
        const shared::Plan& plan = plan_.read();
        if (plan.dropped > 0)
            spdlog::error("{} entries found no room in the lists of tiles; report this", plan.dropped);
        known_.lumelsMarked = plan.lumelsMarked;
        known_.tilesMarked = plan.marked;
        lumelsPending_ = plan.lumelsPending;
        stats_.lumelsLit = plan.lumelsLit;
        stats_.lumelsDerived = plan.lumelsDerived;
        stats_.lumelsPending = plan.lumelsPending;
        stats_.tilesLit = plan.tilesLit;
        stats_.lumelsKept = plan.lumelsMarked - plan.lumelsLit - plan.lumelsDerived;
    }
    stats_.lumelsMarked = known_.lumelsMarked;
    stats_.tilesMarked = known_.tilesMarked;
    stats_.pixelsCovered = known_.pixelsCovered;
    stats_.levelBias = residency_.levelBias();
    stats_.levelOffset = detail_ ? detail_->levelOffset : 0.0f;
    stats_.anisotropy = detail_ ? detail_->anisotropy : 1.0f;
}

// Sub-pixel position of the reference's sample i, in [-0.5, 0.5): the R2 sequence (Roberts 2018, "The
// Unreasonable Effectiveness of Quasirandom Sequences"), from the plastic number. A square grid would beat
// against regular detail such as grooves.
static glm::vec2 shiftOfSample(int i)
{
    const auto fraction = [](double x) { return float(x - std::floor(x)); };
    return {fraction(0.5 + 0.7548776662466927 * i) - 0.5f, fraction(0.5 + 0.5698402909980532 * i) - 0.5f};
}

void Renderer::recordReference(Frame& frame)
{
    Progress progress("reference", size_t(settings_.samples));
    if (sumSamples_ == 0)
        display_.clearSum(frame);
    else
        display_.resumeSum(frame);
    for (int i = 0; i < settings_.samples; ++i) {
        writeView(frame, shiftOfSample(sumSamples_++));
        draw_.record(frame, pool_);
        display_.accumulate(frame);
        finish(frame); // bounded work per submission, and a place for Ctrl-C
        progress.advance(1);
        begin(frame);
    }
}

void Renderer::begin(Frame& frame)
{
    frame.commands.begin(vk::CommandBufferBeginInfo{.flags = vk::CommandBufferUsageFlagBits::eOneTimeSubmit});
    timer_.reset(frame.commands);
}

void Renderer::finish(Frame& frame)
{
    frame.commands.end();
    device_.submitAndWait(frame.commands);
    for (const auto& [name, ms] : timer_.results())
        stats_.passMs[name] += ms;
}

void Renderer::writeView(Frame& frame, glm::vec2 shiftInPixels)
{
    glm::mat4 shift(1.0f);
    shift[3][0] = 2.0f * shiftInPixels.x / float(settings_.size.x);
    shift[3][1] = 2.0f * shiftInPixels.y / float(settings_.size.y);
    shared::View view{.clipFromWorld = shift * frame.clipFromWorld,
                      .eyeInWorld = frame.eye,
                      .lightCount = scene_.lightCount(),
                      .skyRadiance = scene_.skyRadiance(),
                      .exposure = settings_.exposure,
                      .groundRadiance = scene_.groundRadiance(),
                      .anisotropy = frame.detail.anisotropy,
                      .sizePixels = settings_.size,
                      .frame = frame.index,
                      .levelOffset = frame.detail.levelOffset,
                      .objects = scene_.objectTable(),
                      .environment = scene_.environment(),
                      .shadowCount = 0,
                      .shadows = {},
                      .shadowed = {},
                      .worldFromClip = glm::mat4(glm::inverse(glm::dmat4(shift * frame.clipFromWorld)))};
    for (const shared::Shadow& shadow : scene_.shadows()) {
        view.shadows[view.shadowCount++] = shadow;
        view.shadowed[shadow.light / 32] |= 1u << shadow.light % 32;
    }
    scene_.writeView(view);
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
    pool_.clear(settings_.poolBytes);
    residency_ = {};
    first_ = true;
    sumSamples_ = 0;
    knownView_ = glm::mat4(0.0f);
    detail_.reset();
    offsetsSeen_ = 0;
    lumelsPending_ = 0;
    known_ = {};
}

void Renderer::setSettings(const Settings& settings)
{
    const unsigned changed = changes(std::exchange(settings_, settings), settings);
    if (changed & invalidates::targets) {
        targets_ = Targets(device_, settings);
        display_.connect(device_, targets_);
    }
    if (changed & invalidates::sum)
        sumSamples_ = 0; // lumels see to it that what changed is lit again
    if (changed & invalidates::feedback)
        feedback_.resize(device_, settings.size);
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
    }
    if (changed & invalidates::lumels) {
        knownView_ = glm::mat4(0.0f);
        detail_.reset();
    }
}

glm::mat4 Renderer::clipFromWorld(const scene::Camera& camera) const
{
    const float aspect = float(settings_.size.x) / float(settings_.size.y);
    return reversedPerspective(camera.yFov, aspect, camera.nearMetres) *
           glm::lookAt(camera.eye, camera.target, camera.up);
}

// With the scene made ready for it. `settings` and `targets` may be others than the renderer's.
Frame Renderer::makeFrame(const scene::Camera& camera, const Settings& settings, Targets& targets,
                          uint32_t index)
{
    Frame frame{.device = device_,
                .commands = *commands_.front(),
                .timer = timer_,
                .scene = scene_,
                .targets = targets,
                .settings = settings,
                .renderSize = settings.size,
                .clipFromWorld = clipFromWorld(camera),
                .eye = camera.eye,
                .index = index,
                .inView = {},
                .feedback = {},
                .elongations = {},
                .detail = detail_.value_or(tsl::Detail{settings_.levelOffset, settings_.anisotropy}),
                .lumelBudget = settings.lumelBudget,
                .residency = residency_};
    scene_.adjustAmbient(settings_.ambient, index);
    scene_.adjustEnvironment(settings_.environmentIntensity, settings_.environmentRotation, index);
    shadow_.prepare(device_, scene_, settings_, index);
    frame.inView = scene_.objectsInView(frame.clipFromWorld);
    scene_.writeObjects();
    return frame;
}

FrameStats Renderer::renderFrame(const scene::Camera& camera)
{
    if (interrupted())
        throw Interrupted();
    const auto start = std::chrono::steady_clock::now();
    stats_ = {};
    if (budget_)
        quality_ = budget_->quality();
    Frame frame = makeFrame(camera, settings_, targets_, ++frameIndex_);
    frame.renderSize = glm::max(glm::uvec2(glm::round(glm::vec2(settings_.size) * quality_.renderScale)), 1u);
    frame.detail.levelOffset += quality_.levelBias;
    frame.lumelBudget = std::min(settings_.lumelBudget, quality_.lumels);
    renderSize_ = frame.renderSize;
    if (budget_ && settings_.shading == Shading::tsl)
        noteDynamic(frame);
    writeView(frame, glm::vec2(0.0f));
    if (sumSamples_ == 0)
        sumFrame_ = frameIndex_;
    sumView_ = frame.clipFromWorld;
    begin(frame);
    recordFrame(frame);
    finish(frame);
    first_ = first_ && settings_.shading != Shading::tsl;

    stats_.ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    if (settings_.shading == Shading::tsl)
        countLumels(frame);
    stats_.exposure = settings_.exposure;
    stats_.renderScale = quality_.renderScale;
    stats_.budgetBias = quality_.levelBias;
    stats_.lumelBudget = frame.lumelBudget;
    stats_.poolUsedBytes = pool_.bookkeeping().usedBytes();
    stats_.poolCapBytes = pool_.bookkeeping().capBytes();
    stats_.poolTextures = pool_.bookkeeping().textureCount();
    for (size_t i = 0; i < frame.inView.size(); ++i) {
        const bool lit = i < residency_.objects().size() && residency_.objects()[i].texture;
        ++(frame.inView[i] ? (lit ? stats_.objectsTsl : stats_.objectsForward) : stats_.objectsCulled);
    }
    inView_ = frame.inView;
    keepToBudget();
    return stats_;
}

void Renderer::noteDynamic(const Frame& frame)
{
    dynamicInView_ = 0;
    for (size_t i = 0; i < frame.inView.size(); ++i)
        if (frame.inView[i]) {
            dynamicObjects_.note(i, scene_.changedIn(i, frame.index));
            dynamicInView_ += dynamicObjects_.is(i) ? 1 : 0;
        }
}

// Tells the controller what the frame cost, and the user when no quality is low enough.
void Renderer::keepToBudget()
{
    if (!budget_)
        return;
    const auto ms = [&](const char* pass) {
        const auto found = stats_.passMs.find(pass);
        return found == stats_.passMs.end() ? 0.0 : found->second;
    };
    budget_->finished(
        {.total = stats_.ms,
         .find = ms("feedback") + ms("plan") + ms("lower"), // coarser tiles are looked at, lit or not
         .light = ms("light"),
         .draw = ms("draw"),
         .display = ms("display"),
         .found = settings_.shading != Shading::tsl || stats_.passMs.contains("feedback"),
         .lumelsLit = stats_.lumelsLit,
         .lumelsPending = stats_.lumelsPending,
         .lumelsAllowed = settings_.lumelBudget,
         .dynamic = dynamicInView_});
    if (budget_->outOfReach() && !budgetMissed_) {
        spdlog::warn(
            "a frame budget of {:g} ms is out of reach here: about {:.0f} ms at half the render scale; "
            "raise --budget-ms or lower --size{}",
            settings_.budgetMs, budget_->floorMs(), settings_.msaa > 1 ? ", or draw with --msaa 1" : "");
        budgetMissed_ = true;
    }
}

} // namespace lumel
