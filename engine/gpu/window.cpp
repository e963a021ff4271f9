#include "window.h"
#include "barrier.h"
#include "core/error.h"
#include <algorithm>
#include <backends/imgui_impl_vulkan.h>
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>

namespace lumel::gpu {
namespace {

constexpr auto kColour = vk::ImageAspectFlagBits::eColor;

vk::PresentModeKHR vulkanMode(PresentMode mode)
{
    switch (mode) {
    case PresentMode::mailbox:
        return vk::PresentModeKHR::eMailbox;
    case PresentMode::immediate:
        return vk::PresentModeKHR::eImmediate;
    case PresentMode::fifo:
        break;
    }
    return vk::PresentModeKHR::eFifo;
}

// Pictures are display values already: a format that encodes nothing.
vk::SurfaceFormatKHR chooseFormat(const std::vector<vk::SurfaceFormatKHR>& formats)
{
    for (const auto wanted : {vk::Format::eB8G8R8A8Unorm, vk::Format::eR8G8B8A8Unorm})
        for (const auto& format : formats)
            if (format.format == wanted)
                return format;
    throw Error("Vulkan: no 8-bit UNORM surface format; choose another device with --device");
}

// The part of a placement that an image of this size has. A window may have shrunk since the frame began.
Placement clipped(Placement placement, vk::Extent2D size)
{
    const auto clip = [](int32_t at, uint32_t& to, uint32_t& from, uint32_t most) {
        const uint32_t left = uint32_t(std::max(int64_t(most) - at, int64_t(0)));
        if (to <= left)
            return;
        from = uint32_t(uint64_t(from) * left / to);
        to = left;
    };
    vk::Rect2D &to = placement.to, &from = placement.from;
    clip(to.offset.x, to.extent.width, from.extent.width, size.width);
    clip(to.offset.y, to.extent.height, from.extent.height, size.height);
    return placement;
}

bool isEmpty(const Placement& p)
{
    return std::min({p.to.extent.width, p.to.extent.height, p.from.extent.width, p.from.extent.height}) == 0;
}

std::array<vk::Offset3D, 2> cornersOf(const vk::Rect2D& rect)
{
    return {vk::Offset3D{rect.offset.x, rect.offset.y, 0},
            vk::Offset3D{rect.offset.x + int32_t(rect.extent.width),
                         rect.offset.y + int32_t(rect.extent.height), 1}};
}

} // namespace

Window::Window(const Device& device, GLFWwindow* window, PresentMode mode)
    : device_(device), window_(window), mode_(mode), acquired_(device.handle(), vk::SemaphoreCreateInfo{}),
      fence_(device.handle(), vk::FenceCreateInfo{}),
      pool_(device.handle(), {.flags = vk::CommandPoolCreateFlagBits::eResetCommandBuffer,
                              .queueFamilyIndex = device.queueFamily()}),
      commands_(device.handle(), {.commandPool = *pool_, .commandBufferCount = 1})
{
    createSurface();
    createPanels();
}

Window::~Window()
{
    waitIdle();
    ImGui_ImplVulkan_Shutdown();
}

void Window::createSurface()
{
    VkSurfaceKHR surface = VK_NULL_HANDLE;
    if (glfwCreateWindowSurface(*device_.instance(), window_, nullptr, &surface) != VK_SUCCESS)
        throw Error("Vulkan: no surface for the window; update the driver");
    surface_ = vk::raii::SurfaceKHR(device_.instance(), surface);
    if (!device_.physical().getSurfaceSupportKHR(device_.queueFamily(), *surface_))
        throw Error(fmt::format("Vulkan: {} cannot present to this window; choose another with --device",
                                device_.properties().deviceName.data()));
    format_ = chooseFormat(device_.physical().getSurfaceFormatsKHR(*surface_));
}

void Window::createPanels()
{
    using Layout = vk::ImageLayout;
    using Stage = vk::PipelineStageFlagBits;
    const vk::AttachmentDescription colour{.format = format_.format,
                                           .loadOp = vk::AttachmentLoadOp::eLoad,
                                           .storeOp = vk::AttachmentStoreOp::eStore,
                                           .stencilLoadOp = vk::AttachmentLoadOp::eDontCare,
                                           .stencilStoreOp = vk::AttachmentStoreOp::eDontCare,
                                           .initialLayout = Layout::eColorAttachmentOptimal,
                                           .finalLayout = Layout::eColorAttachmentOptimal};
    const vk::AttachmentReference reference{.attachment = 0, .layout = Layout::eColorAttachmentOptimal};
    const vk::SubpassDescription subpass{.colorAttachmentCount = 1, .pColorAttachments = &reference};
    const vk::AccessFlags access =
        vk::AccessFlagBits::eColorAttachmentRead | vk::AccessFlagBits::eColorAttachmentWrite;
    const vk::SubpassDependency dependency{.srcSubpass = VK_SUBPASS_EXTERNAL,
                                           .dstSubpass = 0,
                                           .srcStageMask = Stage::eColorAttachmentOutput,
                                           .dstStageMask = Stage::eColorAttachmentOutput,
                                           .srcAccessMask = access,
                                           .dstAccessMask = access};
    renderPass_ = vk::raii::RenderPass(device_.handle(), {.attachmentCount = 1,
                                                          .pAttachments = &colour,
                                                          .subpassCount = 1,
                                                          .pSubpasses = &subpass,
                                                          .dependencyCount = 1,
                                                          .pDependencies = &dependency});
    const vk::DescriptorPoolSize size{vk::DescriptorType::eCombinedImageSampler, 4};
    panelSets_ = vk::raii::DescriptorPool(device_.handle(),
                                          {.flags = vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet,
                                           .maxSets = 4,
                                           .poolSizeCount = 1,
                                           .pPoolSizes = &size});
    ImGui_ImplVulkan_InitInfo info{};
    info.Instance = *device_.instance();
    info.PhysicalDevice = *device_.physical();
    info.Device = *device_.handle();
    info.QueueFamily = device_.queueFamily();
    info.Queue = *device_.queue();
    info.DescriptorPool = *panelSets_;
    info.PipelineCache = *device_.pipelineCache();
    info.MinImageCount = 2;
    info.ImageCount = 2;
    info.MSAASamples = VK_SAMPLE_COUNT_1_BIT;
    ImGui_ImplVulkan_Init(&info, *renderPass_);
    device_.runOnce([](vk::CommandBuffer commands) { ImGui_ImplVulkan_CreateFontsTexture(commands); });
    ImGui_ImplVulkan_DestroyFontUploadObjects();
}

vk::Extent2D Window::extentBy(const vk::SurfaceCapabilitiesKHR& limits) const
{
    vk::Extent2D extent = limits.currentExtent;
    if (extent.width == ~0u) { // Wayland: the window decides
        int width = 0, height = 0;
        glfwGetFramebufferSize(window_, &width, &height);
        extent.width = std::clamp(uint32_t(width), limits.minImageExtent.width, limits.maxImageExtent.width);
        extent.height =
            std::clamp(uint32_t(height), limits.minImageExtent.height, limits.maxImageExtent.height);
    }
    return extent;
}

void Window::waitIdle() const
{
    const auto lock = device_.lockQueue();
    device_.handle().waitIdle();
}

bool Window::createSwapchain()
{
    waitIdle();
    const auto limits = device_.physical().getSurfaceCapabilitiesKHR(*surface_);
    const vk::Extent2D extent = extentBy(limits);
    if (extent.width == 0 || extent.height == 0)
        return false;
    const auto modes = device_.physical().getSurfacePresentModesKHR(*surface_);
    vk::PresentModeKHR mode = vulkanMode(mode_);
    if (std::find(modes.begin(), modes.end(), mode) == modes.end())
        mode = vk::PresentModeKHR::eFifo; // always there
    uint32_t count = std::max(2u, limits.minImageCount);
    if (limits.maxImageCount > 0)
        count = std::min(count, limits.maxImageCount);
    using Usage = vk::ImageUsageFlagBits;
    framebuffers_.clear();
    views_.clear();
    drawn_.clear();
    vk::raii::SwapchainKHR old = std::move(swapchain_);
    swapchain_ = vk::raii::SwapchainKHR(
        device_.handle(), {.surface = *surface_,
                           .minImageCount = count,
                           .imageFormat = format_.format,
                           .imageColorSpace = format_.colorSpace,
                           .imageExtent = extent,
                           .imageArrayLayers = 1,
                           .imageUsage = Usage::eColorAttachment | Usage::eTransferDst | Usage::eTransferSrc,
                           .preTransform = limits.currentTransform,
                           .compositeAlpha = vk::CompositeAlphaFlagBitsKHR::eOpaque,
                           .presentMode = mode,
                           .clipped = VK_TRUE,
                           .oldSwapchain = *old});
    extent_ = extent;
    createImages();
    outdated_ = false;
    return true;
}

// Of the swapchain, to draw panels over them.
void Window::createImages()
{
    images_.clear();
    for (const VkImage image : swapchain_.getImages())
        images_.emplace_back(image);
    for (const vk::Image image : images_) {
        views_.emplace_back(device_.handle(),
                            vk::ImageViewCreateInfo{.image = image,
                                                    .viewType = vk::ImageViewType::e2D,
                                                    .format = format_.format,
                                                    .subresourceRange = {kColour, 0, 1, 0, 1}});
        framebuffers_.emplace_back(device_.handle(),
                                   vk::FramebufferCreateInfo{.renderPass = *renderPass_,
                                                             .attachmentCount = 1,
                                                             .pAttachments = &*views_.back(),
                                                             .width = extent_.width,
                                                             .height = extent_.height,
                                                             .layers = 1});
        drawn_.emplace_back(device_.handle(), vk::SemaphoreCreateInfo{});
    }
}

void Window::setPresentMode(PresentMode mode)
{
    outdated_ = outdated_ || mode != mode_;
    mode_ = mode;
}

// False when there is nothing to draw on.
bool Window::acquire(uint32_t& image)
{
    int width = 0, height = 0;
    glfwGetFramebufferSize(window_, &width, &height);
    if (width == 0 || height == 0)
        return false;
    if (extent_.width != uint32_t(width) || extent_.height != uint32_t(height))
        outdated_ = true;
    for (int tries = 0; tries < 4; ++tries) {
        try {
            if ((outdated_ || !*swapchain_) && !createSwapchain())
                return false;
            constexpr uint64_t kSecondNs =
                1'000'000'000ull; // a window that is not shown may have none to give
            const auto [result, index] = swapchain_.acquireNextImage(kSecondNs, *acquired_);
            if (result == vk::Result::eSuccess || result == vk::Result::eSuboptimalKHR) {
                image = index;
                return true;
            }
            return false; // timeout, not ready
        } catch (const vk::OutOfDateKHRError&) {
            outdated_ = true;
        } catch (const vk::SurfaceLostKHRError&) {
            waitIdle();
            framebuffers_.clear();
            views_.clear();
            swapchain_ = nullptr;
            surface_ = nullptr;
            createSurface();
            outdated_ = true;
        }
    }
    return false;
}

void Window::record(uint32_t index, const std::vector<Placement>& placements, std::array<float, 3> background,
                    ImDrawData* panels)
{
    const vk::CommandBuffer commands = *commands_.front();
    const vk::Image image = images_[index];
    commands.begin(vk::CommandBufferBeginInfo{.flags = vk::CommandBufferUsageFlagBits::eOneTimeSubmit});
    imageBarrier(commands, image, kColour, Use::acquired, Use::transferWrite);
    const vk::ImageSubresourceRange range{kColour, 0, 1, 0, 1};
    commands.clearColorImage(
        image, vk::ImageLayout::eTransferDstOptimal,
        vk::ClearColorValue(std::array<float, 4>{background[0], background[1], background[2], 1.0f}), range);
    for (const Placement& whole : placements) {
        const Placement placement = clipped(whole, extent_);
        if (isEmpty(placement))
            continue;
        memoryBarrier(commands, Use::transferWrite, Use::transferWrite);
        const vk::ImageSubresourceLayers layers{kColour, 0, 0, 1};
        commands.blitImage(placement.picture->handle(), vk::ImageLayout::eTransferSrcOptimal, image,
                           vk::ImageLayout::eTransferDstOptimal,
                           vk::ImageBlit{.srcSubresource = layers,
                                         .srcOffsets = cornersOf(placement.from),
                                         .dstSubresource = layers,
                                         .dstOffsets = cornersOf(placement.to)},
                           placement.from.extent == placement.to.extent ? vk::Filter::eNearest
                                                                        : vk::Filter::eLinear);
    }
    imageBarrier(commands, image, kColour, Use::transferWrite, Use::colorWrite);
    commands.beginRenderPass(vk::RenderPassBeginInfo{.renderPass = *renderPass_,
                                                     .framebuffer = *framebuffers_[index],
                                                     .renderArea = {{0, 0}, extent_}},
                             vk::SubpassContents::eInline);
    if (panels)
        ImGui_ImplVulkan_RenderDrawData(panels, commands);
    commands.endRenderPass();
    imageBarrier(commands, image, kColour, Use::colorWrite, Use::present);
    commands.end();
}

void Window::show(const std::vector<Placement>& placements, std::array<float, 3> background,
                  ImDrawData* panels)
{
    uint32_t image = 0;
    if (!acquire(image))
        return;
    record(image, placements, background, panels);
    const vk::SemaphoreSubmitInfo wait{.semaphore = *acquired_,
                                       .stageMask = vk::PipelineStageFlagBits2::eTransfer};
    const vk::SemaphoreSubmitInfo signal{.semaphore = *drawn_[image],
                                         .stageMask = vk::PipelineStageFlagBits2::eAllCommands};
    const vk::CommandBufferSubmitInfo submitted{.commandBuffer = *commands_.front()};
    auto lock = device_.lockQueue();
    device_.queue().submit2(vk::SubmitInfo2{.waitSemaphoreInfoCount = 1,
                                            .pWaitSemaphoreInfos = &wait,
                                            .commandBufferInfoCount = 1,
                                            .pCommandBufferInfos = &submitted,
                                            .signalSemaphoreInfoCount = 1,
                                            .pSignalSemaphoreInfos = &signal},
                            *fence_);
    try {
        const auto result = device_.queue().presentKHR(vk::PresentInfoKHR{.waitSemaphoreCount = 1,
                                                                          .pWaitSemaphores = &*drawn_[image],
                                                                          .swapchainCount = 1,
                                                                          .pSwapchains = &*swapchain_,
                                                                          .pImageIndices = &image});
        outdated_ = outdated_ || result == vk::Result::eSuboptimalKHR;
    } catch (const vk::OutOfDateKHRError&) {
        outdated_ = true;
    } catch (const vk::SurfaceLostKHRError&) {
        outdated_ = true; // the next acquire finds it lost, and recreates it
    }
    lock.unlock();
    constexpr uint64_t kTenSecondsNs = 10'000'000'000ull;
    if (device_.handle().waitForFences(*fence_, VK_TRUE, kTenSecondsNs) != vk::Result::eSuccess)
        throw Error("Vulkan: the window's frame did not finish within ten seconds; update the driver");
    device_.handle().resetFences(*fence_);
}

} // namespace lumel::gpu
