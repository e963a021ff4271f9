// The Vulkan device that everything runs on: instance, queue, memory, one-time commands.
#pragma once
#include "memory.h"
#include "pipeline_cache.h"
#include "pipeline_compiler.h"
#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <vector>
#include <vulkan/vulkan_raii.hpp>

namespace lumel::gpu {

struct DeviceOptions {
    std::string device{}; // index, or part of its or its driver's name; empty = the first suitable one
    bool validation = false;
    bool keepPipelines = false; // in the user's cache folder
    bool stage = false;         // write no device memory directly, as where the CPU sees none of it
    bool singleDraws = false;   // draw one object a call, as on a device without indirect draws
    Demands demands{};          // beyond the features that every device must have
    // To present to a window: the instance extensions that its system asks for; empty = no window.
    std::vector<std::string> windowExtensions{};
};

// Names of all Vulkan devices, in the order of their indices.
std::vector<std::string> deviceNames();

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
    PipelineCompiler& compiler() const { return *compiler_; }
    const Limits& limits() const { return limits_; }
    std::string driver() const { return driver_; }
    std::vector<std::string> validationMessages() const;
    // What is allocated of its memory.
    Allocator& memory() const { return *allocator_; }
    // Device memory that the CPU sees is written through copies nevertheless.
    bool stages() const { return stage_; }

    vk::raii::CommandBuffer makeCommands() const; // for the thread that renders
    // Records, submits and waits. For uploads and readbacks, not for frames. From any thread, one at a time.
    void runOnce(const std::function<void(vk::CommandBuffer)>& record) const;
    // From any thread.
    void submit(vk::CommandBuffer commands, vk::Fence fence) const;
    void submit(vk::CommandBuffer commands, const vk::SemaphoreSubmitInfo& signal, vk::Fence fence) const;
    void wait(vk::Fence fence) const; // and reset it
    // While whatever else uses the queue is called.
    std::unique_lock<std::mutex> lockQueue() const { return std::unique_lock(queueMutex_); }
    uint64_t submissions() const { return submissions_; }

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
    Limits limits_;
    std::string driver_;
    uint32_t queueFamily_ = 0;
    bool stage_ = false;
    vk::raii::Device device_ = nullptr;
    std::unique_ptr<Allocator> allocator_;
    std::unique_ptr<PipelineCache> pipelineCache_;
    std::unique_ptr<PipelineCompiler> compiler_ = std::make_unique<PipelineCompiler>(); // dies before these
    vk::raii::Queue queue_ = nullptr;
    vk::raii::CommandPool commandPool_ = nullptr, oncePool_ = nullptr;
    vk::raii::DescriptorPool descriptorPool_ = nullptr;
    vk::raii::Fence onceFence_ = nullptr;
    mutable std::mutex once_; // guards oncePool_ and onceFence_
    mutable std::mutex queueMutex_;
    mutable std::atomic<uint64_t> submissions_ = 0;

    void createInstance();
    void choosePhysical(const DeviceOptions& options);
    void createDevice();
};

} // namespace lumel::gpu
