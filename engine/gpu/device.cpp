#include "device.h"
#include "core/error.h"
#include "drivers.h"
#include "expected_messages.h"
#include "host_work.h"
#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

namespace lumel::gpu {
namespace {

constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";

VKAPI_ATTR VkBool32 VKAPI_CALL onMessage(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                         VkDebugUtilsMessageTypeFlagsEXT,
                                         const VkDebugUtilsMessengerCallbackDataEXT* data, void* user)
{
    const std::string_view id = data->pMessageIdName ? data->pMessageIdName : "";
    if (isExpected(id, data->pMessage))
        return VK_FALSE;
    auto& log = *static_cast<ValidationLog*>(user);
    const std::lock_guard lock(log.mutex);
    log.messages.emplace_back(data->pMessage);
    spdlog::log(severity >= VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT ? spdlog::level::err
                                                                          : spdlog::level::warn,
                "vulkan: {}: {}", id, data->pMessage);
    return VK_FALSE;
}

// The first feature that the device lacks, empty when it has all.
std::string missingFeature(const vk::raii::PhysicalDevice& device)
{
    const auto features = device.getFeatures2<vk::PhysicalDeviceFeatures2, vk::PhysicalDeviceVulkan12Features,
                                              vk::PhysicalDeviceVulkan13Features>();
    const auto& f12 = features.get<vk::PhysicalDeviceVulkan12Features>();
    const auto& f13 = features.get<vk::PhysicalDeviceVulkan13Features>();
    const auto& f10 = features.get<vk::PhysicalDeviceFeatures2>().features;
    if (!f10.shaderStorageImageWriteWithoutFormat)
        return "shaderStorageImageWriteWithoutFormat";
    if (!f12.scalarBlockLayout)
        return "scalarBlockLayout";
    if (!f12.timelineSemaphore)
        return "timelineSemaphore";
    if (!f12.bufferDeviceAddress)
        return "bufferDeviceAddress";
    if (!f13.dynamicRendering)
        return "dynamicRendering";
    if (!f13.synchronization2)
        return "synchronization2";
    if (!f13.maintenance4)
        return "maintenance4";
    return {};
}

// One that draws and computes.
std::optional<uint32_t> queueFamilyOf(const vk::raii::PhysicalDevice& device)
{
    const auto families = device.getQueueFamilyProperties();
    const auto needed = vk::QueueFlagBits::eGraphics | vk::QueueFlagBits::eCompute;
    for (uint32_t i = 0; i < families.size(); ++i)
        if ((families[i].queueFlags & needed) == needed)
            return i;
    return {};
}

// Empty when the device can be used.
std::string whyUnusable(const vk::raii::PhysicalDevice& device, const Demands& demands)
{
    const auto properties = device.getProperties();
    std::string missing = properties.apiVersion < VK_API_VERSION_1_3 ? "Vulkan 1.3" : missingFeature(device);
    const std::optional<uint32_t> family = queueFamilyOf(device);
    if (missing.empty() && !family)
        missing = "a queue family with graphics and compute";
    if (!missing.empty())
        return fmt::format("{} lacks {}", properties.deviceName.data(), missing);
    return fmt::format("{}", fmt::join(unmet(limitsOf(device, *family, demands), demands), ", "));
}

} // namespace

std::vector<std::string> deviceNames()
{
    findDrivers();
    const vk::raii::Context context;
    const vk::ApplicationInfo application{.pApplicationName = "lumel", .apiVersion = VK_API_VERSION_1_3};
    std::vector<std::string> names;
    try {
        const vk::raii::Instance instance(context, vk::InstanceCreateInfo{.pApplicationInfo = &application});
        for (const auto& device : devicesOf(instance))
            names.emplace_back(device.getProperties().deviceName.data());
    } catch (const vk::SystemError&) { // no driver
    }
    return names;
}

Device::Device(const DeviceOptions& options)
    : validation_(options.validation), windowExtensions_(options.windowExtensions), stage_(options.stage)
{
    createInstance();
    choosePhysical(options);
    createDevice();
    pipelineCache_ = std::make_unique<PipelineCache>(device_, properties_, options.keepPipelines);
}

Device::~Device()
{
    if (*device_)
        device_.waitIdle();
}

void Device::createInstance()
{
    findDrivers();
    const vk::ApplicationInfo application{.pApplicationName = "lumel", .apiVersion = VK_API_VERSION_1_3};
    std::vector<const char*> layers, extensions;
    if (validation_) {
        const auto available = context_.enumerateInstanceLayerProperties();
        if (std::none_of(available.begin(), available.end(), [](const vk::LayerProperties& layer) {
                return std::string_view(layer.layerName) == kValidationLayer;
            }))
            throw Error("Vulkan: the validation layer is not installed; install vulkan-validationlayers");
        layers.push_back(kValidationLayer);
        extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
    }
    for (const std::string& extension : windowExtensions_)
        extensions.push_back(extension.c_str());
    const vk::DebugUtilsMessengerCreateInfoEXT messenger{
        .messageSeverity = vk::DebugUtilsMessageSeverityFlagBitsEXT::eWarning |
                           vk::DebugUtilsMessageSeverityFlagBitsEXT::eError,
        .messageType = vk::DebugUtilsMessageTypeFlagBitsEXT::eValidation |
                       vk::DebugUtilsMessageTypeFlagBitsEXT::ePerformance,
        .pfnUserCallback = onMessage,
        .pUserData = validationLog_.get()};
    const auto synchronisation = vk::ValidationFeatureEnableEXT::eSynchronizationValidation;
    const vk::ValidationFeaturesEXT checks{.pNext = &messenger,
                                           .enabledValidationFeatureCount = 1,
                                           .pEnabledValidationFeatures = &synchronisation};
    vk::InstanceCreateInfo info{.pNext = validation_ ? &checks : nullptr, .pApplicationInfo = &application};
    info.setPEnabledLayerNames(layers).setPEnabledExtensionNames(extensions);
    try {
        instance_ = vk::raii::Instance(context_, info);
        if (validation_)
            messenger_ = vk::raii::DebugUtilsMessengerEXT(instance_, messenger);
    } catch (const vk::SystemError& e) {
        throw Error(fmt::format("Vulkan: no instance ({}); install a driver, for example mesa-vulkan-drivers",
                                e.what()));
    }
}

void Device::choosePhysical(const DeviceOptions& options)
{
    const std::string& wanted = options.device;
    std::vector<vk::raii::PhysicalDevice> devices = devicesOf(instance_);
    if (devices.empty())
        throw Error("Vulkan: no device; install a driver, for example mesa-vulkan-drivers");
    size_t index = devices.size();
    const auto parsed = std::from_chars(wanted.data(), wanted.data() + wanted.size(), index);
    const bool byIndex =
        !wanted.empty() && parsed.ec == std::errc() && parsed.ptr == wanted.data() + wanted.size();
    std::string reasons;
    for (size_t i = 0; i < devices.size() && !*physical_; ++i) {
        if (byIndex ? i != index : !isNamed(devices[i], wanted))
            continue;
        const std::string reason = whyUnusable(devices[i], options.demands);
        if (reason.empty())
            physical_ = std::move(devices[i]);
        else
            reasons += fmt::format(" ({})", reason);
    }
    if (!*physical_)
        throw Error(
            fmt::format("Vulkan: no usable device{}{}; update the driver or choose another with --device",
                        wanted.empty() ? "" : " named " + wanted, reasons));
    properties_ = physical_.getProperties();
    queueFamily_ = *queueFamilyOf(physical_);
    limits_ = limitsOf(physical_, queueFamily_, options.demands);
    limits_.mostIndirectDraws *= options.singleDraws ? 0u : 1u;
    const auto chain =
        physical_.getProperties2<vk::PhysicalDeviceProperties2, vk::PhysicalDeviceDriverProperties>();
    const auto& driver = chain.get<vk::PhysicalDeviceDriverProperties>();
    const uint32_t api = properties_.apiVersion;
    driver_ = fmt::format("{}{}{}, Vulkan {}.{}.{}", driver.driverName.data(),
                          *driver.driverInfo.data() ? " " : "", driver.driverInfo.data(),
                          VK_API_VERSION_MAJOR(api), VK_API_VERSION_MINOR(api), VK_API_VERSION_PATCH(api));
}

void Device::createDevice()
{
    const float priority = 1.0f;
    const char* swapchain = VK_KHR_SWAPCHAIN_EXTENSION_NAME;
    const vk::DeviceQueueCreateInfo queue{
        .queueFamilyIndex = queueFamily_, .queueCount = 1, .pQueuePriorities = &priority};
    const vk::StructureChain<vk::DeviceCreateInfo, vk::PhysicalDeviceFeatures2,
                             vk::PhysicalDeviceVulkan12Features, vk::PhysicalDeviceVulkan13Features>
        info({.queueCreateInfoCount = 1,
              .pQueueCreateInfos = &queue,
              .enabledExtensionCount = windowExtensions_.empty() ? 0u : 1u,
              .ppEnabledExtensionNames = &swapchain},
             {.features = {.multiDrawIndirect = limits_.mostIndirectDraws > 0,
                           .drawIndirectFirstInstance = limits_.mostIndirectDraws > 0,
                           .shaderStorageImageWriteWithoutFormat = VK_TRUE}},
             {.scalarBlockLayout = VK_TRUE, .timelineSemaphore = VK_TRUE, .bufferDeviceAddress = VK_TRUE},
             {.synchronization2 = VK_TRUE, .dynamicRendering = VK_TRUE, .maintenance4 = VK_TRUE});
    device_ = vk::raii::Device(physical_, info.get<vk::DeviceCreateInfo>());
    allocator_ = std::make_unique<Allocator>(device_, physical_.getMemoryProperties(), limits_);
    queue_ = vk::raii::Queue(device_, queueFamily_, 0);
    const vk::CommandPoolCreateInfo pool{.flags = vk::CommandPoolCreateFlagBits::eResetCommandBuffer,
                                         .queueFamilyIndex = queueFamily_};
    commandPool_ = vk::raii::CommandPool(device_, pool);
    oncePool_ = vk::raii::CommandPool(device_, pool);
    // Sets: one a pool block and a pass, a few of each renderer's for each frame in flight. Materials have a
    // pool of their own.
    const vk::DescriptorPoolSize sizes[] = {{vk::DescriptorType::eCombinedImageSampler, 16384},
                                            {vk::DescriptorType::eStorageImage, 16384},
                                            {vk::DescriptorType::eUniformBuffer, 1024},
                                            {vk::DescriptorType::eUniformTexelBuffer, 1024}};
    descriptorPool_ =
        vk::raii::DescriptorPool(device_, {.flags = vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet,
                                           .maxSets = 8192,
                                           .poolSizeCount = uint32_t(std::size(sizes)),
                                           .pPoolSizes = sizes});
    onceFence_ = vk::raii::Fence(device_, vk::FenceCreateInfo{});
}

std::vector<std::string> Device::validationMessages() const
{
    const std::lock_guard lock(validationLog_->mutex);
    return validationLog_->messages;
}

void Device::submit(vk::CommandBuffer commands, vk::Fence fence) const
{
    const vk::CommandBufferSubmitInfo submitted{.commandBuffer = commands};
    const auto lock = lockQueue();
    queue_.submit2(vk::SubmitInfo2{.commandBufferInfoCount = 1, .pCommandBufferInfos = &submitted}, fence);
    ++submissions_;
}

void Device::submit(vk::CommandBuffer commands, const vk::SemaphoreSubmitInfo& signal, vk::Fence fence) const
{
    const vk::CommandBufferSubmitInfo submitted{.commandBuffer = commands};
    const auto lock = lockQueue();
    queue_.submit2(vk::SubmitInfo2{.commandBufferInfoCount = 1,
                                   .pCommandBufferInfos = &submitted,
                                   .signalSemaphoreInfoCount = 1,
                                   .pSignalSemaphoreInfos = &signal},
                   fence);
    ++submissions_;
}

void Device::wait(vk::Fence fence) const
{
    constexpr uint64_t kTenMinutesNs = 600'000'000'000ull;
    ++hostWork().waits;
    if (device_.waitForFences(fence, VK_TRUE, kTenMinutesNs) != vk::Result::eSuccess)
        throw Error("Vulkan: the device did not finish within ten minutes; lower --size or --samples");
    device_.resetFences(fence);
}

vk::raii::CommandBuffer Device::makeCommands() const
{
    vk::raii::CommandBuffers buffers(device_, {.commandPool = *commandPool_, .commandBufferCount = 1});
    return std::move(buffers.front());
}

void Device::runOnce(const std::function<void(vk::CommandBuffer)>& record) const
{
    const std::lock_guard lock(once_);
    const vk::raii::CommandBuffers buffers(device_, {.commandPool = *oncePool_, .commandBufferCount = 1});
    const vk::CommandBuffer commands = *buffers.front();
    commands.begin(vk::CommandBufferBeginInfo{.flags = vk::CommandBufferUsageFlagBits::eOneTimeSubmit});
    record(commands);
    commands.end();
    submit(commands, *onceFence_);
    wait(*onceFence_);
}

void Device::beginLabel(vk::CommandBuffer commands, const char* text) const
{
    if (validation_)
        commands.beginDebugUtilsLabelEXT(vk::DebugUtilsLabelEXT{.pLabelName = text},
                                         *device_.getDispatcher());
}

void Device::endLabel(vk::CommandBuffer commands) const
{
    if (validation_)
        commands.endDebugUtilsLabelEXT(*device_.getDispatcher());
}

} // namespace lumel::gpu
