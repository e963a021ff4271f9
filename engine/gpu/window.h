// A window's surface and swapchain: pictures are copied into its image, panels drawn over them, the image
// shown. One image is in flight at a time, since frames are waited for.
#pragma once
#include "present_mode.h"
#include "resource.h"
#include <memory>

struct GLFWwindow;
struct ImDrawData;

namespace lumel::gpu {

// A part of a picture and where in the window it goes, in pixels. Sizes may differ: it is then scaled.
struct Placement {
    const Image* picture = nullptr; // in use transferRead
    vk::Rect2D from, to;
};

class Window {
public:
    // Throws Error when the device cannot present to the window. Needs an ImGui context.
    Window(const Device& device, GLFWwindow* window, PresentMode mode);
    ~Window();
    Window(const Window&) = delete;
    Window& operator=(const Window&) = delete;

    // Shows the placements on `background` (linear order: later ones cover earlier ones) under the panels.
    // Does nothing while the window has no area. A lost or outdated swapchain is recreated.
    void show(const std::vector<Placement>& placements, std::array<float, 3> background, ImDrawData* panels);
    void setPresentMode(PresentMode mode);
    PresentMode presentMode() const { return mode_; } // as asked for; fifo serves where it is missing

private:
    void createSurface();
    vk::Extent2D extentBy(const vk::SurfaceCapabilitiesKHR& limits) const;
    void waitIdle() const;
    bool createSwapchain(); // false: the window has no area
    void createImages();
    void createPanels();
    bool acquire(uint32_t& image);
    void record(uint32_t image, const std::vector<Placement>& placements, std::array<float, 3> background,
                ImDrawData* panels);

    const Device& device_;
    GLFWwindow* window_;
    PresentMode mode_;
    // Declared in creation order, since they die in reverse.
    vk::raii::SurfaceKHR surface_ = nullptr;
    vk::SurfaceFormatKHR format_;
    vk::raii::RenderPass renderPass_ = nullptr; // the panels' back end takes no other kind
    vk::raii::DescriptorPool panelSets_ = nullptr;
    vk::raii::SwapchainKHR swapchain_ = nullptr;
    vk::Extent2D extent_{0, 0};
    std::vector<vk::Image> images_;
    std::vector<vk::raii::ImageView> views_;
    std::vector<vk::raii::Framebuffer> framebuffers_;
    std::vector<vk::raii::Semaphore> drawn_; // an image's: presenting waits for it
    vk::raii::Semaphore acquired_ = nullptr;
    vk::raii::Fence fence_ = nullptr;
    vk::raii::CommandPool pool_ = nullptr; // other threads may record at the same time
    vk::raii::CommandBuffers commands_ = nullptr;
    bool outdated_ = true;
};

} // namespace lumel::gpu
