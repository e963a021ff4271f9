#include "display.h"
#include <X11/Xatom.h>
#include <X11/Xutil.h>
#include <X11/extensions/XTest.h>
#include <chrono>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

namespace lumel::view {
namespace {

using Clock = std::chrono::steady_clock;

// Windows vanish at any time; that is no reason to end.
int ignoreErrors(::Display*, XErrorEvent*)
{
    return 0;
}

} // namespace

void pause(int milliseconds)
{
    std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
}

Display::Display()
{
    int ends[2];
    if (pipe(ends) != 0)
        return;
    server_ = fork();
    if (server_ == 0) {
        const int quiet = open("/dev/null", O_WRONLY);
        dup2(quiet, STDERR_FILENO);
        const std::string number = std::to_string(ends[1]);
        execlp("Xvfb", "Xvfb", "-displayfd", number.c_str(), "-screen", "0", "1920x1200x24", "-nolisten",
               "tcp", static_cast<char*>(nullptr));
        _exit(127);
    }
    close(ends[1]);
    char digits[16] = {};
    ssize_t count = 0, more = 0;
    while (count < 15 && (more = read(ends[0], digits + count, size_t(15 - count))) > 0) {
        count += more;
        if (digits[count - 1] == '\n')
            break;
    }
    close(ends[0]);
    if (count <= 0)
        return;
    name_ = ":" + std::to_string(std::atoi(digits));
    XSetErrorHandler(ignoreErrors);
    display_ = XOpenDisplay(name_.c_str());
    if (display_)
        own_ = XCreateSimpleWindow(display_, DefaultRootWindow(display_), 0, 0, 1, 1, 0, 0, 0);
}

Display::~Display()
{
    if (display_)
        XCloseDisplay(display_);
    if (server_ > 0) {
        kill(server_, SIGTERM);
        waitpid(server_, nullptr, 0);
    }
}

std::string Display::titleOf(Window window)
{
    char* text = nullptr;
    std::string title;
    if (XFetchName(display_, window, &text) && text) {
        title = text;
        XFree(text);
    }
    return title;
}

Window Display::find(const std::string& title, double seconds)
{
    const auto end = Clock::now() + std::chrono::duration<double>(seconds);
    while (Clock::now() < end) {
        Window root = 0, parent = 0, *children = nullptr, found = 0;
        unsigned count = 0;
        if (XQueryTree(display_, DefaultRootWindow(display_), &root, &parent, &children, &count)) {
            for (unsigned i = 0; i < count; ++i)
                if (titleOf(children[i]) == title)
                    found = children[i];
            if (children)
                XFree(children);
        }
        if (found)
            return found;
        pause(50);
    }
    return 0;
}

void Display::moveTo(Window window, int x, int y)
{
    int rootX = 0, rootY = 0;
    Window child = 0;
    XTranslateCoordinates(display_, window, DefaultRootWindow(display_), x, y, &rootX, &rootY, &child);
    XTestFakeMotionEvent(display_, -1, rootX, rootY, CurrentTime);
    XSync(display_, False);
    pause(20);
}

void Display::press(int button, bool down)
{
    XTestFakeButtonEvent(display_, unsigned(button), down, CurrentTime);
    XSync(display_, False);
    pause(20);
}

void Display::drag(Window window, int button, int x0, int y0, int x1, int y1)
{
    moveTo(window, x0, y0);
    press(button, true);
    for (int i = 1; i <= 5; ++i)
        moveTo(window, x0 + (x1 - x0) * i / 5, y0 + (y1 - y0) * i / 5);
    press(button, false);
}

void Display::key(const std::string& name, const std::vector<std::string>& held)
{
    const auto send = [this](const std::string& key, bool down) {
        const KeyCode code = XKeysymToKeycode(display_, XStringToKeysym(key.c_str()));
        XTestFakeKeyEvent(display_, code, down, CurrentTime);
        XSync(display_, False);
        pause(10);
    };
    for (const std::string& modifier : held)
        send(modifier, true);
    send(name, true);
    send(name, false);
    for (const std::string& modifier : held)
        send(modifier, false);
    pause(50);
}

void Display::resize(Window window, int width, int height)
{
    XResizeWindow(display_, window, unsigned(width), unsigned(height));
    XSync(display_, False);
}

void Display::show(Window window, bool shown)
{
    shown ? XMapWindow(display_, window) : XUnmapWindow(display_, window);
    XSync(display_, False);
    pause(100);
    if (shown)
        XSetInputFocus(display_, window, RevertToParent, CurrentTime);
    XSync(display_, False);
}

bool Display::waitFor(int type, XEvent& event)
{
    const auto end = Clock::now() + std::chrono::seconds(20);
    while (Clock::now() < end) {
        if (XCheckTypedWindowEvent(display_, own_, type, &event))
            return true;
        pause(5);
    }
    return false;
}

bool Display::drop(Window window, const std::filesystem::path& file, int x, int y)
{
    const auto atom = [this](const char* name) { return XInternAtom(display_, name, False); };
    const Atom selection = atom("XdndSelection"), uris = atom("text/uri-list");
    XSetSelectionOwner(display_, selection, own_, CurrentTime);
    const auto tell = [&](const char* type, long a, long b, long c, long d) {
        XEvent event{};
        event.xclient.type = ClientMessage;
        event.xclient.window = window;
        event.xclient.message_type = atom(type);
        event.xclient.format = 32;
        event.xclient.data.l[0] = long(own_);
        event.xclient.data.l[1] = a;
        event.xclient.data.l[2] = b;
        event.xclient.data.l[3] = c;
        event.xclient.data.l[4] = d;
        XSendEvent(display_, window, False, NoEventMask, &event);
        XSync(display_, False);
    };
    int rootX = 0, rootY = 0;
    Window child = 0;
    XTranslateCoordinates(display_, window, DefaultRootWindow(display_), x, y, &rootX, &rootY, &child);
    tell("XdndEnter", 5l << 24, long(uris), 0, 0);
    tell("XdndPosition", 0, long(rootX) << 16 | rootY, CurrentTime, long(atom("XdndActionCopy")));
    XEvent event{};
    if (!waitFor(ClientMessage, event)) // XdndStatus
        return false;
    tell("XdndDrop", 0, CurrentTime, 0, 0);
    if (!waitFor(SelectionRequest, event))
        return false;
    const std::string text = "file://" + file.string() + "\r\n";
    const XSelectionRequestEvent& asked = event.xselectionrequest;
    XChangeProperty(display_, asked.requestor, asked.property, asked.target, 8, PropModeReplace,
                    reinterpret_cast<const unsigned char*>(text.data()), int(text.size()));
    XEvent reply{};
    reply.xselection.type = SelectionNotify;
    reply.xselection.requestor = asked.requestor;
    reply.xselection.selection = asked.selection;
    reply.xselection.target = asked.target;
    reply.xselection.property = asked.property;
    reply.xselection.time = asked.time;
    XSendEvent(display_, asked.requestor, False, NoEventMask, &reply);
    XSync(display_, False);
    return waitFor(ClientMessage, event); // XdndFinished
}

std::vector<uint8_t> Display::pixels(Window window, int x, int y, int width, int height)
{
    XImage* image = XGetImage(display_, window, x, y, unsigned(width), unsigned(height), AllPlanes, ZPixmap);
    std::vector<uint8_t> rgb;
    if (!image)
        return rgb;
    rgb.reserve(size_t(width) * size_t(height) * 3);
    for (int row = 0; row < height; ++row)
        for (int column = 0; column < width; ++column) {
            const unsigned long pixel = XGetPixel(image, column, row);
            for (const int shift : {16, 8, 0})
                rgb.push_back(uint8_t(pixel >> shift));
        }
    XDestroyImage(image);
    return rgb;
}

std::string Display::clipboard()
{
    const Atom property = XInternAtom(display_, "LUMEL_TEST", False);
    XConvertSelection(display_, XInternAtom(display_, "CLIPBOARD", False),
                      XInternAtom(display_, "UTF8_STRING", False), property, own_, CurrentTime);
    XEvent event{};
    if (!waitFor(SelectionNotify, event) || event.xselection.property == None)
        return {};
    Atom type = 0;
    int format = 0;
    unsigned long count = 0, left = 0;
    unsigned char* data = nullptr;
    XGetWindowProperty(display_, own_, property, 0, 65536, True, AnyPropertyType, &type, &format, &count,
                       &left, &data);
    std::string text(reinterpret_cast<char*>(data), count);
    XFree(data);
    return text;
}

} // namespace lumel::view
