// Keys and mouse: from GLFW's callbacks to changes of the state. Events are kept until they are looked at, so
// that a slow frame loses none.
#pragma once
#include "theme.h"

struct GLFWwindow;

namespace lumel::ui {

class Input {
public:
    // Installs the callbacks; before ImGui's back end, which calls on what it finds.
    explicit Input(GLFWwindow* window);
    // After ImGui::NewFrame(), which says what the panels take.
    void apply(ViewState& state, const Layout& layout, float seconds);
    // Whether something happened since the last call of apply().
    bool any() const { return !events_.empty() || !dropped_.empty(); }
    // The camera is moved by a held key or button.
    bool steers() const { return flying_ || (drag_ != Drag::none && orbiting_); }

private:
    struct Event {
        enum Kind { key, character, button, move, scroll, window } kind; // window: it looks different now
        int code = 0;                                                    // key, code point or button
        int mods = 0;
        bool down = false;
        glm::vec2 at{0.0f}; // the cursor, or how far was scrolled
    };
    enum class Drag { none, orbit, look, pan, split };
    static Input& of(GLFWwindow* window);
    static void noteWindow(GLFWwindow* window);
    void onKey(ViewState& state, const Event& event);
    void onButton(ViewState& state, const Layout& layout, const Event& event);
    void onMove(ViewState& state, const Layout& layout, glm::vec2 at);
    void fly(ViewState& state, float seconds);

    GLFWwindow* window_;
    std::vector<Event> events_;
    std::vector<std::filesystem::path> dropped_;
    glm::vec2 cursor_{-1.0f}, pressedAt_{0.0f}, dragAt_{0.0f};
    Drag drag_ = Drag::none;
    bool orbiting_ = false; // the drag has left the place of a click
    int dragButton_ = 0;
    double lastClick_ = -1.0; // seconds
    glm::vec2 lastClickAt_{0.0f};
    bool flying_ = false;
};

} // namespace lumel::ui
