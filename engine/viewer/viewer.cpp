#include "viewer.h"
#include "app/command_line.h"
#include "app/setup.h"
#include "core/error.h"
#include "core/file.h"
#include "core/progress.h"
#include "panels.h"
#include "renderer/demands.h"
#include "scene/pick.h"
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_vulkan.h>
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>
#include <limits>
#include <spdlog/spdlog.h>
#include <unistd.h>

namespace lumel {
namespace {

constexpr size_t kHistory = 240; // frames in the graph
constexpr double kMessageSeconds = 6.0;
constexpr double kAnimationStep = 1.0 / 30.0; // seconds
// Seconds between redraws: after input, which the panels follow over a few frames; while the view or an
// animation moves, and while something is loaded, which needs the time more.
constexpr double kRedraw = 1.0 / 60.0, kSteeringRedraw = 1.0 / 30.0, kLoadingRedraw = 0.1;
constexpr double kLongestWait = 0.25; // seconds, until Ctrl-C is looked for again
constexpr int kRedrawsOfInput = 3;

} // namespace

Viewer::Frontend::Frontend(const ViewArguments& arguments)
{
    glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
    glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_TRUE);
    window = glfwCreateWindow(int(arguments.settings.size.x), int(arguments.settings.size.y), "Lumel",
                              nullptr, nullptr);
    if (!window)
        throw Error("cannot create a window on this display; use lumel shot");
    glfwSetWindowSizeLimits(window, 320, 240, GLFW_DONT_CARE, GLFW_DONT_CARE);
    // Where the system's window coordinates are points, not pixels, they are scaled already.
    float contentScale = 1.0f;
    int width = 1, pixels = 1;
    glfwGetWindowContentScale(window, &contentScale, nullptr);
    glfwGetWindowSize(window, &width, nullptr);
    glfwGetFramebufferSize(window, &pixels, nullptr);
    scale = std::clamp(contentScale * float(width) / float(std::max(pixels, 1)), 1.0f, 4.0f);
    ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr;
    ui::applyTheme(scale);
    input = std::make_unique<ui::Input>(window);
    ImGui_ImplGlfw_InitForVulkan(window, true);
}

Viewer::Frontend::~Frontend()
{
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
    glfwDestroyWindow(window);
}

Viewer::Viewer(const ViewArguments& arguments)
    : arguments_(arguments), frontend_(arguments), loader_(glfwPostEmptyEvent)
{
    state_.settings = arguments.settings;
    state_.autoExposure = arguments.exposure == ExposureChoice::automatic;
    state_.exposureChosen = arguments.exposure != ExposureChoice::perScene;
    state_.sides = {ui::Side{arguments.settings.shading, arguments.filter},
                    ui::Side{arguments.rightShading, arguments.rightFilter}};
    state_.split = arguments.split;
    state_.panels = arguments.panels;
    state_.presentMode = arguments.presentMode;
    state_.hint = ui::hintWanted();
    beginLoading(arguments.scene); // the driver takes its time, too
    device_ = std::make_unique<gpu::Device>(deviceOptions(arguments));
    if (device_->properties().deviceType == vk::PhysicalDeviceType::eCpu) {
        gpu::DeviceOptions options = deviceOptions(arguments);
        options.keepPipelines = false;
        ownDevice_ = std::make_unique<gpu::Device>(options);
    }
    const gpu::Device& shows = ownDevice_ ? *ownDevice_ : *device_;
    window_ = std::make_unique<gpu::Window>(shows, frontend_.window, arguments.presentMode);
    thread_ = std::make_unique<SceneThread>(*device_, shows, glfwPostEmptyEvent);
    report_.device = device_->properties().deviceName.data();
}

Viewer::~Viewer()
{
    loader_.cancel();
}

std::vector<std::string> Viewer::validationMessages() const
{
    std::vector<std::string> messages = device_->validationMessages();
    if (ownDevice_)
        for (const std::string& message : ownDevice_->validationMessages())
            messages.push_back(message);
    return messages;
}

void Viewer::run()
{
    while (!glfwWindowShouldClose(frontend_.window) && !state_.requests.quit) {
        await();
        frame();
    }
}

void Viewer::abandon()
{
    constexpr auto kPatience = std::chrono::milliseconds(200);
    loader_.cancel();
    if (!thread_->endsWithin(kPatience))
        _exit(sayInterrupted());
}

bool Viewer::minimised() const
{
    return glfwGetWindowAttrib(frontend_.window, GLFW_ICONIFIED) != 0;
}

// Seconds after the last redraw; infinite unless something moves by itself.
double Viewer::untilRedraw() const
{
    constexpr double kNever = std::numeric_limits<double>::infinity();
    if (minimised())
        return kNever;
    if (redraws_ > 0)
        return kRedraw;
    if (frontend_.input->steers() || (state_.playing && !state_.paused) ||
        (state_.autoExposure && exposureKnown_ && !state_.paused && !adaptation_.arrived()))
        return kSteeringRedraw;
    // Progress, a result, a blinking cursor.
    if (loader_.busy() || uploading_ || inspector_.busy() || ImGui::GetIO().WantTextInput)
        return kLoadingRedraw;
    const double message = report_.messageUntil - lastFrame_;
    return message > 0.0 ? message : kNever;
}

// Until the window is to be drawn again: after input, with a finished frame of the scene, or for what moves
// by itself.
void Viewer::await()
{
    const double due = lastFrame_ + untilRedraw();
    // Redrawing more often would take the scene's time.
    const double soonest = lastFrame_ + (frontend_.input->steers() ? kSteeringRedraw : kRedraw);
    glfwPollEvents();
    while (!thread_->hasResult()) {
        if (interrupted())
            throw Interrupted();
        const double now = glfwGetTime(), until = frontend_.input->any() ? soonest : due;
        if (now >= until || glfwWindowShouldClose(frontend_.window))
            return;
        glfwWaitEventsTimeout(std::min(until - now, kLongestWait));
    }
}

void Viewer::frame()
{
    const double now = glfwGetTime();
    const float seconds = float(now - lastFrame_);
    lastFrame_ = now;
    redraws_ = frontend_.input->any() ? kRedrawsOfInput : std::max(redraws_ - 1, 0);
    if (reported_ && loader_.busy()) // and drawn
        loader_.proceed();
    collect();
    ImGui_ImplVulkan_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    ImGui::NewFrame();
    const auto layoutNow = [this] {
        return ui::layoutOf(state_, ImGui::GetIO().DisplaySize, frontend_.scale);
    };
    const bool hinted = state_.hint;
    frontend_.input->apply(state_, layoutNow(), seconds);
    const ui::Layout layout = layoutNow();
    ui::drawPanels(state_, report_, layout);
    ImGui::Render();
    if (hinted && !state_.hint)
        ui::rememberHint();
    window_->setPresentMode(state_.presentMode);
    finishLoading();
    act(layout);
    takeWaitingScreenshots();
    changeEnvironment();
    loadMissing();
    if (!minimised()) {
        state_.settings.size = pictureSize(layout);
        play(seconds);
        expose(seconds);
    }
    request();
    if (!minimised()) {
        inspect(layout);
        show(layout);
    }
    setTitle();
}

glm::uvec2 Viewer::pictureSize(const ui::Layout& layout) const
{
    const ImVec2 ratio = ImGui::GetIO().DisplayFramebufferScale;
    return glm::clamp(glm::uvec2(layout.picture.x * ratio.x, layout.picture.y * ratio.y), glm::uvec2(1u),
                      glm::uvec2(8192u));
}

// The animation keeps to the clock in whole steps, and goes on where it was after a wait.
void Viewer::play(double seconds)
{
    if (!state_.playing || !scene_ || scene_->animation.seconds <= 0.0)
        return;
    if (state_.paused)
        seconds = state_.step ? kAnimationStep : 0.0;
    played_ = state_.seconds ? played_ + std::min(seconds, 0.25) : 0.0;
    state_.seconds = kAnimationStep * std::floor(played_ / kAnimationStep + 1e-6);
}

// Exposure adapts to the view. A scene with lights of its own is metered once, to find out whether it must.
void Viewer::expose(double seconds)
{
    const std::optional<LuminanceHistogram> histogram = std::exchange(metered_, std::nullopt);
    if (!scene_ || !(state_.autoExposure || exposureAsked_) || state_.paused) {
        adaptation_.reset();
        exposureKnown_ = false;
        return;
    }
    if (histogram) {
        exposureKnown_ = true;
        if (std::exchange(exposureAsked_, false)) {
            state_.autoExposure = needsExposure(*histogram);
            if (!state_.autoExposure) {
                state_.settings.exposure = 1.0f;
                return;
            }
            spdlog::info("exposure {} (auto)", automaticExposure(*histogram));
        }
        adaptation_.aim(automaticExposure(*histogram));
    }
    if (exposureKnown_)
        state_.settings.exposure = adaptation_.advance(seconds);
}

// Says what is to be rendered from now on.
void Viewer::request()
{
    if (!scene_ || uploading_)
        return;
    const bool meters = (state_.autoExposure || exposureAsked_) && !state_.paused;
    thread_->post({.state = state_,
                   .meter = meters,
                   .pictures = !meters || exposureKnown_,
                   .suspended = minimised() || (state_.paused && !state_.step)});
}

// What the scene's thread has done since.
void Viewer::collect()
{
    const std::optional<SceneResult> result = thread_->take();
    if (!result || !scene_)
        return;
    if (result->metered)
        metered_ = result->metered;
    report_.finished = result->finished;
    if (result->frames.empty())
        return;
    state_.step = false;
    report_.sides = result->report.sides;
    report_.methods = result->report.methods;
    report_.referenceSamples = result->report.referenceSamples;
    report_.residency = result->residency;
    report_.ambient = result->ambient;
    report_.history.insert(report_.history.end(), result->frames.begin(), result->frames.end());
    while (report_.history.size() > kHistory)
        report_.history.pop_front();
    if (uploading_ || (loader_.busy() && !loader_.baking())) // something else
        return;
    if (!std::exchange(reported_, true))
        spdlog::info("{}: shown after {:.1f} s", arguments_.scene.string(), glfwGetTime() - asked_);
}

void Viewer::show(const ui::Layout& layout)
{
    std::vector<gpu::Placement> placements;
    const glm::uvec2 window = pictureSize(layout);
    const auto place = [&](size_t side, float from, float to) {
        const gpu::Image* picture = thread_->pictures(side).latest();
        if (!picture)
            return;
        const auto part = [from, to](vk::Extent2D size) {
            const auto left = uint32_t(std::round(from * float(size.width)));
            const auto right = uint32_t(std::round(to * float(size.width)));
            return vk::Rect2D{{int32_t(left), 0}, {right - left, size.height}};
        };
        placements.push_back(
            {.picture = picture, .from = part(picture->extent()), .to = part({window.x, window.y})});
    };
    place(0, 0.0f, state_.split ? state_.splitAt : 1.0f);
    if (state_.split)
        place(1, state_.splitAt, 1.0f);
    else
        thread_->pictures(1).forget();
    window_->show(placements, ui::kBackground, ImGui::GetDrawData());
}

// The texel under the cursor, of the level that the picture reads there.
void Viewer::inspect(const ui::Layout& layout)
{
    inspector_.take(report_.inspection);
    const auto scene = scene_;
    if (!state_.panels || !state_.materialTab || !scene || state_.cursor.x < 0.0f)
        return;
    const auto baked =
        thread_->materials(report_.methods[state_.split && state_.cursor.x > state_.splitAt ? 1 : 0]);
    const scene::Camera& camera = state_.camera.camera();
    const float aspect = layout.picture.x / layout.picture.y;
    const auto hit = scene::pick(*scene, scene::rayThrough(camera, state_.cursor, aspect));
    if (!hit || !baked)
        return;
    ui::Texel texel{.material = size_t(scene->objects[hit->object].material)};
    const scene::Reflectance& reflectance = (*baked)[texel.material].reflectance;
    const float pixelMetres =
        2.0f * std::tan(0.5f * camera.yFov) * hit->distance / float(state_.settings.size.y);
    const float texels = pixelMetres * hit->uvPerMetre * float(reflectance.size().x);
    texel.level =
        std::clamp(int(std::lround(std::log2(std::max(texels, 1.0f)))), 0, int(reflectance.levels()) - 1);
    const glm::ivec2 size = reflectance.normal.size(size_t(texel.level));
    const glm::vec2 uv = hit->uv - glm::floor(hit->uv);
    texel.x = std::min(int(uv.x * float(size.x)), size.x - 1);
    texel.y = std::min(int(uv.y * float(size.y)), size.y - 1);
    inspector_.look(scene, baked, texel);
}

void Viewer::say(const std::string& message, bool isError)
{
    report_.message = message;
    report_.messageIsError = isError;
    report_.messageUntil = glfwGetTime() + kMessageSeconds;
    (isError ? spdlog::warn("{}", message) : spdlog::info("{}", message));
}

void Viewer::setTitle()
{
    std::string title = scene_ ? arguments_.scene.filename().string() + " - Lumel" : "Lumel";
    if (loader_.busy())
        title += loader_.baking() ? " (baking)" : " (loading)";
    if (title != title_)
        glfwSetWindowTitle(frontend_.window, title.c_str());
    title_ = title;
}

} // namespace lumel
