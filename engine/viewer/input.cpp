#include "input.h"
#include "renderer/names.h"
#include <algorithm>
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace lumel::ui {
namespace {

constexpr float kClickPixels = 4.0f;
constexpr double kDoubleClickSeconds = 0.4;
constexpr float kSplitGrip = 8.0f; // pixels at 96 dpi

template<class Enum>
Enum stepped(Enum value, size_t count, bool back)
{
    return Enum((size_t(value) + (back ? count - 1 : 1)) % count);
}

// A place of the window in the picture, (0, 0) to (1, 1).
glm::vec2 inPicture(glm::vec2 at, const Layout& layout)
{
    return at / glm::vec2(layout.picture.x, layout.picture.y);
}

} // namespace

Input& Input::of(GLFWwindow* window)
{
    return *static_cast<Input*>(glfwGetWindowUserPointer(window));
}

void Input::noteWindow(GLFWwindow* window)
{
    of(window).events_.push_back({.kind = Event::window});
}

Input::Input(GLFWwindow* window) : window_(window)
{
    glfwSetWindowUserPointer(window, this);
    glfwSetKeyCallback(window, [](GLFWwindow* w, int key, int, int action, int mods) {
        if (action == GLFW_PRESS)
            of(w).events_.push_back({.kind = Event::key, .code = key, .mods = mods, .down = true});
    });
    glfwSetCharCallback(window, [](GLFWwindow* w, unsigned character) {
        of(w).events_.push_back({.kind = Event::character, .code = int(character)});
    });
    glfwSetMouseButtonCallback(window, [](GLFWwindow* w, int button, int action, int mods) {
        of(w).events_.push_back({.kind = Event::button,
                                 .code = button,
                                 .mods = mods,
                                 .down = action == GLFW_PRESS,
                                 .at = of(w).cursor_});
    });
    glfwSetCursorPosCallback(window, [](GLFWwindow* w, double x, double y) {
        of(w).cursor_ = {x, y};
        of(w).events_.push_back({.kind = Event::move, .at = of(w).cursor_});
    });
    glfwSetScrollCallback(window, [](GLFWwindow* w, double x, double y) {
        of(w).events_.push_back({.kind = Event::scroll, .at = {x, y}});
    });
    glfwSetWindowRefreshCallback(window, noteWindow);
    glfwSetFramebufferSizeCallback(window, [](GLFWwindow* w, int, int) { noteWindow(w); });
    glfwSetWindowIconifyCallback(window, [](GLFWwindow* w, int) { noteWindow(w); });
    glfwSetWindowFocusCallback(window, [](GLFWwindow* w, int) { noteWindow(w); });
    glfwSetCursorEnterCallback(window, [](GLFWwindow* w, int) { noteWindow(w); });
    glfwSetDropCallback(window, [](GLFWwindow* w, int count, const char** paths) {
        of(w).dropped_.assign(paths, paths + count);
        double x = 0.0, y = 0.0;
        glfwGetCursorPos(w, &x, &y);
        of(w).cursor_ = {x, y};
        of(w).events_.push_back({.kind = Event::move, .at = of(w).cursor_});
    });
}

void Input::onKey(ViewState& state, const Event& event)
{
    const bool shift = event.mods & GLFW_MOD_SHIFT, control = event.mods & GLFW_MOD_CONTROL;
    Requests& r = state.requests;
    switch (event.code) {
    case GLFW_KEY_1:
    case GLFW_KEY_2:
    case GLFW_KEY_3:
        state.activeSide().shading = Shading(event.code - GLFW_KEY_1);
        break;
    case GLFW_KEY_F:
        state.activeSide().filter = stepped(state.activeSide().filter, kFilterNames.size(), shift);
        break;
    case GLFW_KEY_V:
        state.settings.view = stepped(state.settings.view, kViewNames.size(), shift);
        break;
    case GLFW_KEY_X:
        state.split = !state.split;
        break;
    case GLFW_KEY_C:
        r.copyCommand = true;
        break;
    case GLFW_KEY_F12:
        (shift ? r.screenshotExr : r.screenshotPng) = true;
        break;
    case GLFW_KEY_R:
        r.reloadShaders = true;
        break;
    case GLFW_KEY_SPACE:
        state.paused = !state.paused;
        break;
    case GLFW_KEY_PERIOD:
        state.paused = state.step = true;
        break;
    case GLFW_KEY_P:
        state.playing = !state.playing;
        break;
    case GLFW_KEY_H:
        state.panels = !state.panels;
        break;
    case GLFW_KEY_F11:
        r.fullscreen = true;
        break;
    case GLFW_KEY_HOME:
        r.reset = true;
        break;
    case GLFW_KEY_F1:
        state.help = !state.help;
        state.hint = false;
        break;
    case GLFW_KEY_ESCAPE:
        state.help = state.hint = false;
        state.selected.reset();
        break;
    case GLFW_KEY_Q:
        r.quit = r.quit || control;
        break;
    default:
        break;
    }
}

void Input::onButton(ViewState& state, const Layout& layout, const Event& event)
{
    if (!event.down) {
        if (event.code != dragButton_ || drag_ == Drag::none)
            return;
        const bool click = drag_ != Drag::split && event.code == GLFW_MOUSE_BUTTON_LEFT &&
                           glm::distance(event.at, pressedAt_) < kClickPixels * layout.scale;
        drag_ = Drag::none;
        if (!click)
            return;
        const double now = glfwGetTime();
        state.requests.pickAt = inPicture(event.at, layout);
        state.requests.pick = true;
        state.requests.focus = now - lastClick_ < kDoubleClickSeconds &&
                               glm::distance(event.at, lastClickAt_) < kClickPixels * layout.scale;
        lastClick_ = now;
        lastClickAt_ = event.at;
        return;
    }
    if (drag_ != Drag::none || event.at.x < 0.0f || event.at.x >= layout.picture.x)
        return;
    dragButton_ = event.code;
    pressedAt_ = event.at;
    const bool onSplit =
        state.split && std::abs(event.at.x - state.splitAt * layout.picture.x) < kSplitGrip * layout.scale;
    if (event.code == GLFW_MOUSE_BUTTON_RIGHT)
        drag_ = Drag::look;
    else if (event.code == GLFW_MOUSE_BUTTON_MIDDLE || (event.mods & GLFW_MOD_SHIFT))
        drag_ = Drag::pan;
    else
        drag_ = onSplit ? Drag::split : Drag::orbit;
}

void Input::onMove(ViewState& state, const Layout& layout, glm::vec2 at)
{
    const glm::vec2 step = (at - dragAt_) / layout.picture.y;
    dragAt_ = at;
    switch (drag_) {
    case Drag::none:
        break;
    case Drag::split:
        state.splitAt = std::clamp(at.x / layout.picture.x, 0.02f, 0.98f);
        break;
    case Drag::orbit:
        // What moves less is a click.
        if (glm::distance(at, pressedAt_) >= kClickPixels * layout.scale || orbiting_) {
            orbiting_ = true;
            state.camera.orbit({-step.x, step.y});
        }
        break;
    case Drag::look:
        state.camera.look({-0.5f * step.x, -0.5f * step.y});
        break;
    case Drag::pan:
        state.camera.pan({-step.x, step.y});
        break;
    }
}

void Input::fly(ViewState& state, float seconds)
{
    const bool goesOn = std::exchange(flying_, false);
    if (ImGui::GetIO().WantTextInput || glfwGetKey(window_, GLFW_KEY_LEFT_CONTROL) == GLFW_PRESS)
        return;
    const auto held = [this](int plus, int minus) {
        return float(glfwGetKey(window_, plus) == GLFW_PRESS) -
               float(glfwGetKey(window_, minus) == GLFW_PRESS);
    };
    const glm::vec3 direction(held(GLFW_KEY_D, GLFW_KEY_A), held(GLFW_KEY_E, GLFW_KEY_Q),
                              held(GLFW_KEY_W, GLFW_KEY_S));
    flying_ = direction != glm::vec3(0.0f);
    const bool fast = glfwGetKey(window_, GLFW_KEY_LEFT_SHIFT) == GLFW_PRESS;
    if (flying_)
        state.camera.fly((fast ? 2.0f : 0.5f) * direction, std::min(seconds, goesOn ? 0.2f : 0.03f));
}

void Input::apply(ViewState& state, const Layout& layout, float seconds)
{
    const ImGuiIO& io = ImGui::GetIO();
    for (const Event& event : std::exchange(events_, {})) {
        switch (event.kind) {
        case Event::key:
            if (!io.WantTextInput)
                onKey(state, event);
            break;
        case Event::character:
            if (event.code == '?' && !io.WantTextInput)
                state.help = !state.help, state.hint = false;
            break;
        case Event::button:
            if (event.down)
                dragAt_ = event.at, orbiting_ = false;
            if (!event.down || !io.WantCaptureMouse)
                onButton(state, layout, event);
            break;
        case Event::move:
            onMove(state, layout, event.at);
            break;
        case Event::scroll:
            if (!io.WantCaptureMouse)
                state.camera.dolly(event.at.y);
            break;
        case Event::window:
            break;
        }
    }
    const bool inside = cursor_.x >= 0.0f && cursor_.y >= 0.0f && cursor_.x < layout.picture.x &&
                        cursor_.y < layout.picture.y && !io.WantCaptureMouse;
    state.cursor = inside ? inPicture(cursor_, layout) : glm::vec2(-1.0f);
    if (!dropped_.empty()) {
        state.requests.open = std::exchange(dropped_, {});
        state.requests.openAt = inPicture(cursor_, layout);
    }
    fly(state, seconds);
}

} // namespace lumel::ui
