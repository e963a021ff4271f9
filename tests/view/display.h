// An X server without a screen, and what a user does on it: keys, mouse, window sizes, dropped files. The
// events come from the server, as a real user's do.
#pragma once
#include <X11/Xlib.h>
#include <cstdint>
#include <filesystem>
#include <string>
#include <sys/types.h>
#include <vector>

namespace lumel::view {

void pause(int milliseconds);

class Display {
public:
    Display(); // started() is false where Xvfb is missing
    ~Display();
    Display(const Display&) = delete;
    Display& operator=(const Display&) = delete;
    bool started() const { return display_ != nullptr; }
    const std::string& name() const { return name_; } // for DISPLAY

    // The window of this title, once there is one; 0 after `seconds` without.
    Window find(const std::string& title, double seconds = 60.0);
    // Window coordinates, pixels.
    void moveTo(Window window, int x, int y);
    void press(int button, bool down);
    void drag(Window window, int button, int x0, int y0, int x1, int y1);
    void key(const std::string& name, const std::vector<std::string>& held = {}); // X11 key names
    void resize(Window window, int width, int height);
    void show(Window window, bool shown);
    // By the protocol XDND, version 5, as a file manager does. False when the window did not take it.
    bool drop(Window window, const std::filesystem::path& file, int x, int y);
    // What the window shows there: rows of RGB, 0 to 255. Empty when it cannot be read.
    std::vector<uint8_t> pixels(Window window, int x, int y, int width, int height);
    // What is on the clipboard, empty when it is not text.
    std::string clipboard();

private:
    std::string titleOf(Window window);
    bool waitFor(int type, XEvent& event);

    ::Display* display_ = nullptr;
    pid_t server_ = 0;
    std::string name_;
    Window own_ = 0;
};

} // namespace lumel::view
