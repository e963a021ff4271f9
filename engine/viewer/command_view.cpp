#include "app/example_scenes.h"
#include "core/error.h"
#include "viewer.h"
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace lumel {
namespace {

std::string lastGlfwError;

// GLFW's life; windows are made and destroyed within it.
struct Glfw {
    Glfw()
    {
        glfwSetErrorCallback([](int, const char* text) { lastGlfwError = text; });
        if (!glfwInit())
            throw Error(fmt::format("no display for a window ({}); set DISPLAY, or use lumel shot",
                                    lastGlfwError.empty() ? "GLFW" : lastGlfwError));
        if (!glfwVulkanSupported()) {
            glfwTerminate();
            throw Error("Vulkan: no device can present to a window; install a driver, for example "
                        "mesa-vulkan-drivers");
        }
    }
    ~Glfw() { glfwTerminate(); }
};

} // namespace

void runView(const ViewArguments& arguments)
{
    if (arguments.listDevices) {
        const std::vector<std::string> names = gpu::deviceNames();
        if (names.empty())
            throw Error("Vulkan: no device; install a driver, for example mesa-vulkan-drivers");
        for (size_t i = 0; i < names.size(); ++i)
            fmt::print("{} {}\n", i, names[i]);
        return;
    }
#ifdef __GLIBC__
    // Freed materials leave holes of many MiB in the heap, which glibc's growing threshold would keep: large
    // blocks go back to the system, however many scenes and filters were shown.
    mallopt(M_MMAP_THRESHOLD, 1 << 20);
#endif
    const Glfw glfw;
    uint32_t count = 0;
    const char** extensions = glfwGetRequiredInstanceExtensions(&count);
    ViewArguments complete = arguments;
    complete.device.windowExtensions.assign(extensions, extensions + count);
    if (complete.scene.empty())
        complete.scene = exampleScene("record");
    std::vector<std::string> messages;
    {
        Viewer viewer(complete);
        try {
            viewer.run();
        } catch (const Interrupted&) {
            viewer.abandon();
            throw;
        }
        messages = viewer.validationMessages();
    }
    if (!messages.empty())
        throw Error(fmt::format("Vulkan validation: {} messages; report them", messages.size()));
}

} // namespace lumel
