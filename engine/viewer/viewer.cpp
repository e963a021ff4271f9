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
#include <spdlog/spdlog.h>

namespace lumel {
namespace {

constexpr size_t kHistory = 240; // frames in the graph
constexpr double kMessageSeconds = 6.0;
constexpr double kAnimationStep = 1.0 / 30.0; // seconds
constexpr double kLoadingStep = 0.1;          // seconds between redraws, which cost the loader time

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
    beginLoading(arguments.scene); // the driver takes its time, too
    device_ = std::make_unique<gpu::Device>(deviceOptions(arguments));
    window_ = std::make_unique<gpu::Window>(*device_, frontend_.window, arguments.presentMode);
    renderers_ = std::make_unique<ViewRenderers>(*device_);
    report_.device = device_->properties().deviceName.data();
}

Viewer::~Viewer()
{
    loader_.cancel();
}

void Viewer::run()
{
    while (!glfwWindowShouldClose(frontend_.window) && !state_.requests.quit) {
        if (interrupted())
            throw Interrupted();
        if (loader_.busy() && !frontend_.input->any())
            glfwWaitEventsTimeout(kLoadingStep);
        else if (idle())
            glfwWaitEventsTimeout(0.25);
        else
            glfwPollEvents();
        frame();
    }
}

// Nothing will change unless something happens.
bool Viewer::idle() const
{
    const bool minimised = glfwGetWindowAttrib(frontend_.window, GLFW_ICONIFIED) != 0;
    if (minimised)
        return true;
    if (inspector_.busy() || frontend_.input->any())
        return false;
    return !renderers_->scene() || ((!state_.autoExposure || adaptation_.arrived()) &&
                                    ((renderers_->finished() && !state_.playing) || state_.paused));
}

void Viewer::frame()
{
    const double now = glfwGetTime();
    const float seconds = float(now - lastFrame_);
    lastFrame_ = now;
    ImGui_ImplVulkan_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    ImGui::NewFrame();
    const auto layoutNow = [this] {
        return ui::layoutOf(state_, ImGui::GetIO().DisplaySize, frontend_.scale);
    };
    frontend_.input->apply(state_, layoutNow(), seconds);
    const ui::Layout layout = layoutNow();
    ui::drawPanels(state_, report_, layout);
    ImGui::Render();
    window_->setPresentMode(state_.presentMode);
    finishLoading();
    act(layout);
    changeEnvironment();
    loadMissing();
    if (glfwGetWindowAttrib(frontend_.window, GLFW_ICONIFIED) == 0) {
        state_.settings.size = pictureSize(layout);
        play(seconds);
        expose(seconds);
        render();
        inspect(layout);
        show(layout);
        noteFirstPicture();
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
    const auto scene = renderers_->scene();
    if (!state_.playing || !scene || scene->animation.seconds <= 0.0)
        return;
    if (state_.paused)
        seconds = state_.step ? kAnimationStep : 0.0;
    played_ = state_.seconds ? played_ + std::min(seconds, 0.25) : 0.0;
    state_.seconds = kAnimationStep * std::floor(played_ / kAnimationStep + 1e-6);
}

// Exposure adapts to the view. A scene with lights of its own is metered once, to find out whether it must.
void Viewer::expose(double seconds)
{
    if (!renderers_->scene() || !(state_.autoExposure || exposureAsked_) || state_.paused) {
        adaptation_.reset();
        return;
    }
    if (const auto histogram = renderers_->meter(state_, state_.settings.size)) {
        if (std::exchange(exposureAsked_, false)) {
            state_.autoExposure = needsExposure(*histogram);
            if (!state_.autoExposure)
                return;
            spdlog::info("exposure {} (auto)", automaticExposure(*histogram));
        }
        adaptation_.aim(automaticExposure(*histogram));
    }
    state_.settings.exposure = adaptation_.advance(seconds);
}

void Viewer::render()
{
    if (state_.paused && !state_.step)
        return;
    state_.step = false;
    const double start = glfwGetTime();
    if (!renderers_->render(state_, state_.settings.size, report_))
        return;
    ui::FrameSample sample{.ms = float(1000.0 * (glfwGetTime() - start)), .passMs = {}};
    for (size_t side = 0; side < (state_.split ? 2u : 1u); ++side)
        for (const auto& [pass, ms] : report_.sides[side].stats.passMs)
            sample.passMs[pass] += ms;
    report_.history.push_back(std::move(sample));
    if (report_.history.size() > kHistory)
        report_.history.pop_front();
    report_.residency = renderers_->residency(0);
    report_.ambient = renderers_->ambient();
}

void Viewer::show(const ui::Layout& layout)
{
    std::vector<gpu::Placement> placements;
    const glm::uvec2 window = pictureSize(layout);
    const auto place = [&](size_t side, float from, float to) {
        const gpu::Image* picture = renderers_->picture(side);
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
    window_->show(placements, ui::kBackground, ImGui::GetDrawData());
}

void Viewer::noteFirstPicture()
{
    if (!asked_ || loader_.busy() || !renderers_->picture(0))
        return;
    spdlog::info("{}: shown after {:.1f} s", arguments_.scene.string(), glfwGetTime() - *asked_);
    asked_.reset();
}

// The texel under the cursor, of the level that the picture reads there.
void Viewer::inspect(const ui::Layout& layout)
{
    inspector_.take(report_.inspection);
    const auto scene = renderers_->scene();
    if (!state_.panels || !state_.materialTab || !scene || state_.cursor.x < 0.0f)
        return;
    const auto baked =
        renderers_->materials(renderers_->method(state_.split && state_.cursor.x > state_.splitAt));
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
    std::string title = renderers_->scene() ? arguments_.scene.filename().string() + " - Lumel" : "Lumel";
    if (loader_.busy())
        title += " (loading)";
    if (title != title_)
        glfwSetWindowTitle(frontend_.window, title.c_str());
    title_ = title;
}

} // namespace lumel
