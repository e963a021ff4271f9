// The Vulkan device that everything runs on: instance, queue, memory, one-time commands.
#pragma once
#include "limits.h"
#include "pipeline_cache.h"
#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>
#include <vulkan/vulkan_raii.hpp>

namespace lumel::gpu {

struct DeviceOptions {
    std::string device{}; // index, or part of its or its driver's name; empty = the first suitable one
    bool validation = false;
    bool keepPipelines = false; // in the user's cache folder
    Demands demands{};          // beyond the features that every device must have
    // To present to a window: the instance extensions that its system asks for; empty = no window.
    std::vector<std::string> windowExtensions{};
};

// Names of all Vulkan devices, in the order of their indices.
std::vector<std::string> deviceNames();

// What is allocated of a device's memory: drivers limit the number of allocations.
struct MemoryCount {
    std::atomic<uint32_t> allocations = 0;
    std::atomic<uint64_t> bytes = 0;
};
struct FreesCounted {
    uint64_t bytes = 0;
    void operator()(MemoryCount* count) const
    {
        --count->allocations;
        count->bytes -= bytes;
    }
};

// Device memory, counted while it lives.
struct Memory {
    vk::raii::DeviceMemory handle = nullptr;
    bool seenByHost = false; // can be mapped, and is coherent
    std::unique_ptr<MemoryCount, FreesCounted> counted{};
};

// Validation messages, collected while the device lives; tests fail on any.
struct ValidationLog {
    std::mutex mutex;
    std::vector<std::string> messages;
};

class Device {
public:
    // Throws Error when no Vulkan 1.3 device with the needed features exists, naming what is missing.
    explicit Device(const DeviceOptions& options = {});
    ~Device();
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;

    const vk::raii::Device& handle() const { return device_; }
    const vk::raii::Instance& instance() const { return instance_; }
    const vk::raii::PhysicalDevice& physical() const { return physical_; }
    uint32_t queueFamily() const { return queueFamily_; }
    const vk::raii::Queue& queue() const { return queue_; }
    const vk::raii::CommandPool& commandPool() const { return commandPool_; }
    const vk::raii::DescriptorPool& descriptorPool() const { return descriptorPool_; }
    const vk::PhysicalDeviceProperties& properties() const { return properties_; }
    const vk::raii::PipelineCache& pipelineCache() const { return pipelineCache_->handle(); }
    const Limits& limits() const { return limits_; }
    std::string driver() const { return driver_; }
    std::vector<std::string> validationMessages() const;
    uint64_t allocatedBytes() const { return memoryCount_.bytes; }

    // Throws Error with the remedy when out of memory.
    Memory allocate(const vk::MemoryRequirements& requirements, vk::MemoryPropertyFlags wanted,
                    const std::string& remedy, bool deviceAddress = false) const;

    vk::raii::CommandBuffer makeCommands() const;
    // Records, submits and waits. For uploads and readbacks, not for frames. By one thread at a time: others
    // wait, but no frame may be under way.
    void runOnce(const std::function<void(vk::CommandBuffer)>& record) const;
    void submitAndWait(vk::CommandBuffer commands) const;

    // Debug name of any Vulkan object; shown by validation and by capture tools.
    template<class Handle>
    void name(const Handle& object, const std::string& text) const
    {
        if (!validation_)
            return;
        using Raw = std::remove_cvref_t<decltype(*object)>;
        device_.setDebugUtilsObjectNameEXT(
            {.objectType = Raw::objectType,
             .objectHandle = reinterpret_cast<uint64_t>(static_cast<typename Raw::CType>(*object)),
             .pObjectName = text.c_str()});
    }
    void beginLabel(vk::CommandBuffer commands, const char* text) const;
    void endLabel(vk::CommandBuffer commands) const;

private:
    // Declared in creation order, since they die in reverse.
    bool validation_ = false;
    std::vector<std::string> windowExtensions_;
    std::unique_ptr<ValidationLog> validationLog_ = std::make_unique<ValidationLog>();
    vk::raii::Context context_;
    vk::raii::Instance instance_ = nullptr;
    vk::raii::DebugUtilsMessengerEXT messenger_ = nullptr;
    vk::raii::PhysicalDevice physical_ = nullptr;
    vk::PhysicalDeviceProperties properties_;
    vk::PhysicalDeviceMemoryProperties memory_;
    Limits limits_;
    std::string driver_;
    uint32_t queueFamily_ = 0;
    vk::raii::Device device_ = nullptr;
    std::unique_ptr<PipelineCache> pipelineCache_;
    vk::raii::Queue queue_ = nullptr;
    vk::raii::CommandPool commandPool_ = nullptr;
    vk::raii::DescriptorPool descriptorPool_ = nullptr;
    vk::raii::Fence fence_ = nullptr;
    mutable MemoryCount memoryCount_;
    mutable std::mutex once_; // queue and command pool serve one thread

    void createInstance();
    void choosePhysical(const DeviceOptions& options);
    void createDevice();
};

} // namespace lumel::gpu
