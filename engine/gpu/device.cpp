#include "device.h"
#include "core/error.h"
#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

namespace lumel::gpu {
namespace {

constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";

VKAPI_ATTR VkBool32 VKAPI_CALL onMessage(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                         VkDebugUtilsMessageTypeFlagsEXT types,
                                         const VkDebugUtilsMessengerCallbackDataEXT* data, void* user)
{
    // Advice about speed that we do not follow: lit textures stay in the general layout, because light,
    // lower, copies and draw take turns on parts of one image.
    constexpr int32_t kGeneralLayout = 0x4dae5635;
    if (types == VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT && data->messageIdNumber == kGeneralLayout)
        return VK_FALSE;
    auto& log = *static_cast<ValidationLog*>(user);
    const std::lock_guard lock(log.mutex);
    log.messages.emplace_back(data->pMessage);
    spdlog::log(severity >= VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT ? spdlog::level::err
                                                                          : spdlog::level::warn,
                "vulkan: {}", data->pMessage);
    return VK_FALSE;
}

int preference(vk::PhysicalDeviceType type)
{
    switch (type) {
    case vk::PhysicalDeviceType::eDiscreteGpu:
        return 0;
    case vk::PhysicalDeviceType::eIntegratedGpu:
        return 1;
    case vk::PhysicalDeviceType::eVirtualGpu:
        return 2;
    default:
        return 3;
    }
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

} // namespace

std::vector<std::string> deviceNames()
{
    const vk::raii::Context context;
    const vk::ApplicationInfo application{.pApplicationName = "lumel", .apiVersion = VK_API_VERSION_1_3};
    std::vector<std::string> names;
    try {
        const vk::raii::Instance instance(context, vk::InstanceCreateInfo{.pApplicationInfo = &application});
        for (const auto& device : vk::raii::PhysicalDevices(instance))
            names.emplace_back(device.getProperties().deviceName.data());
    } catch (const vk::SystemError&) { // no driver
    }
    return names;
}

Device::Device(const DeviceOptions& options)
    : validation_(options.validation), windowExtensions_(options.windowExtensions)
{
    createInstance();
    choosePhysical(options.device);
    createDevice();
}

Device::~Device()
{
    if (*device_)
        device_.waitIdle();
}

void Device::createInstance()
{
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

void Device::choosePhysical(const std::string& wanted)
{
    vk::raii::PhysicalDevices devices = nullptr;
    try {
        devices = vk::raii::PhysicalDevices(instance_);
    } catch (const vk::SystemError&) {
    }
    if (devices.empty())
        throw Error("Vulkan: no device; install a driver, for example mesa-vulkan-drivers");
    std::vector<size_t> order(devices.size());
    for (size_t i = 0; i < order.size(); ++i)
        order[i] = i;
    std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) {
        return preference(devices[a].getProperties().deviceType) <
               preference(devices[b].getProperties().deviceType);
    });
    size_t index = devices.size();
    const auto parsed = std::from_chars(wanted.data(), wanted.data() + wanted.size(), index);
    const bool byIndex =
        !wanted.empty() && parsed.ec == std::errc() && parsed.ptr == wanted.data() + wanted.size();
    std::string reasons;
    for (const size_t i : order) {
        const auto properties = devices[i].getProperties();
        const std::string name = properties.deviceName.data();
        if (byIndex ? i != index : name.find(wanted) == std::string::npos)
            continue;
        std::string missing =
            properties.apiVersion < VK_API_VERSION_1_3 ? "Vulkan 1.3" : missingFeature(devices[i]);
        if (missing.empty()) {
            physical_ = std::move(devices[i]);
            properties_ = properties;
            break;
        }
        reasons += fmt::format(" ({} lacks {})", name, missing);
    }
    if (!*physical_)
        throw Error(
            fmt::format("Vulkan: no usable device{}{}; update the driver or choose another with --device",
                        wanted.empty() ? "" : " named " + wanted, reasons));
    memory_ = physical_.getMemoryProperties();
    const auto chain =
        physical_.getProperties2<vk::PhysicalDeviceProperties2, vk::PhysicalDeviceDriverProperties>();
    const auto& driver = chain.get<vk::PhysicalDeviceDriverProperties>();
    driver_ = fmt::format("{} {}", driver.driverName.data(), driver.driverInfo.data());
}

void Device::createDevice()
{
    const auto families = physical_.getQueueFamilyProperties();
    const auto needed = vk::QueueFlagBits::eGraphics | vk::QueueFlagBits::eCompute;
    const auto family = std::find_if(families.begin(), families.end(),
                                     [&](const auto& f) { return (f.queueFlags & needed) == needed; });
    if (family == families.end())
        throw Error("Vulkan: the device has no graphics queue; choose another with --device");
    queueFamily_ = uint32_t(family - families.begin());

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
             {.features = {.shaderStorageImageWriteWithoutFormat = VK_TRUE}},
             {.scalarBlockLayout = VK_TRUE, .bufferDeviceAddress = VK_TRUE},
             {.synchronization2 = VK_TRUE, .dynamicRendering = VK_TRUE, .maintenance4 = VK_TRUE});
    device_ = vk::raii::Device(physical_, info.get<vk::DeviceCreateInfo>());
    queue_ = vk::raii::Queue(device_, queueFamily_, 0);
    commandPool_ =
        vk::raii::CommandPool(device_, {.flags = vk::CommandPoolCreateFlagBits::eResetCommandBuffer,
                                        .queueFamilyIndex = queueFamily_});
    // Sets: one a material, a pool block and a pass. 4096 materials with 8 images each fill it.
    const vk::DescriptorPoolSize sizes[] = {{vk::DescriptorType::eCombinedImageSampler, 32768},
                                            {vk::DescriptorType::eStorageImage, 16384},
                                            {vk::DescriptorType::eUniformBuffer, 64}};
    descriptorPool_ =
        vk::raii::DescriptorPool(device_, {.flags = vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet,
                                           .maxSets = 8192,
                                           .poolSizeCount = 3,
                                           .pPoolSizes = sizes});
    fence_ = vk::raii::Fence(device_, vk::FenceCreateInfo{});
}

std::vector<std::string> Device::validationMessages() const
{
    const std::lock_guard lock(validationLog_->mutex);
    return validationLog_->messages;
}

vk::raii::DeviceMemory Device::allocate(const vk::MemoryRequirements& requirements,
                                        vk::MemoryPropertyFlags wanted, bool deviceAddress) const
{
    for (uint32_t i = 0; i < memory_.memoryTypeCount; ++i) {
        const bool fits = requirements.memoryTypeBits & (1u << i);
        if (!fits || (memory_.memoryTypes[i].propertyFlags & wanted) != wanted)
            continue;
        const vk::MemoryAllocateFlagsInfo flags{.flags = vk::MemoryAllocateFlagBits::eDeviceAddress};
        try {
            return {device_,
                    {.pNext = deviceAddress ? &flags : nullptr,
                     .allocationSize = requirements.size,
                     .memoryTypeIndex = i}};
        } catch (const vk::OutOfDeviceMemoryError&) {
        } catch (const vk::OutOfHostMemoryError&) {
        }
    }
    throw Error(fmt::format("Vulkan: {} MiB of device memory are not to be had; lower --size or --pool-mb",
                            requirements.size >> 20));
}

void Device::submitAndWait(vk::CommandBuffer commands) const
{
    const vk::CommandBufferSubmitInfo submitted{.commandBuffer = commands};
    queue_.submit2(vk::SubmitInfo2{.commandBufferInfoCount = 1, .pCommandBufferInfos = &submitted}, *fence_);
    constexpr uint64_t kTenMinutesNs = 600'000'000'000ull;
    if (device_.waitForFences(*fence_, VK_TRUE, kTenMinutesNs) != vk::Result::eSuccess)
        throw Error("Vulkan: the device did not finish within ten minutes; lower --size or --samples");
    device_.resetFences(*fence_);
}

void Device::runOnce(const std::function<void(vk::CommandBuffer)>& record) const
{
    const vk::raii::CommandBuffers buffers(device_, {.commandPool = *commandPool_, .commandBufferCount = 1});
    const vk::CommandBuffer commands = *buffers.front();
    commands.begin(vk::CommandBufferBeginInfo{.flags = vk::CommandBufferUsageFlagBits::eOneTimeSubmit});
    record(commands);
    commands.end();
    submitAndWait(commands);
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
