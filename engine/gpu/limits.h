// What a device supports, and in one line each what it does not: pure functions of what it reported once.
#pragma once
#include <map>
#include <string>
#include <vector>
#include <vulkan/vulkan_raii.hpp>

namespace lumel::gpu {

struct Limits {
    std::string device; // name
    vk::PhysicalDeviceLimits core;
    vk::DeviceSize maxBufferSize = 0, maxMemoryAllocationSize = 0;
    uint32_t subgroupSize = 0;
    vk::ShaderStageFlags subgroupStages;
    vk::SubgroupFeatureFlags subgroupOperations;
    uint32_t timestampValidBits = 0; // of the queue
    uint32_t mostIndirectDraws = 0;  // a call, each with a first instance; 0: it has none
    std::map<vk::Format, vk::FormatFeatureFlags2> formats; // optimal tiling, of those asked for
};

// What one use of a format asks of it.
struct FormatDemand {
    vk::Format format;
    vk::FormatFeatureFlags2 features;
    const char* what; // it is
};

// What a program asks of any device, whatever it renders. Zero: nothing.
struct Demands {
    uint32_t groupInvocations = 0, groupWidth = 0; // compute
    uint32_t sharedBytes = 0;
    uint32_t pushBytes = 0;
    uint32_t sets = 0;
    uint32_t sampledImages = 0, storageImages = 0, uniformBuffers = 0; // bound at a time, each stage
    uint32_t uniformBytes = 0;
    uint32_t vertexAttributes = 0, vertexBindings = 0, vertexStride = 0;
    vk::SampleCountFlags samples;                // of colour and depth targets
    vk::SubgroupFeatureFlags computeSubgroups{}; // of any size
    bool timestamps = false;
    std::vector<FormatDemand> formats{};
};

Limits limitsOf(const vk::raii::PhysicalDevice& device, uint32_t queueFamily, const Demands& demands);

// One line for each demand that is not met: "X has maxPushConstantsSize 64, 128 needed". Empty: all are.
std::vector<std::string> unmet(const Limits& limits, const Demands& demands);

// The same for one image of a format and usage that has these properties.
struct ImageDemand {
    uint32_t width = 1, height = 1, layers = 1, mips = 1;
    vk::SampleCountFlagBits samples = vk::SampleCountFlagBits::e1;
    std::string remedy; // "use a smaller --size"
};
std::vector<std::string> unmet(const std::string& device, const vk::ImageFormatProperties& properties,
                               const ImageDemand& demand);

// For so many bytes in one allocation, as the `count`th that lives.
std::vector<std::string> unmet(const Limits& limits, vk::DeviceSize bytes, uint32_t count,
                               const std::string& remedy);

} // namespace lumel::gpu
