#include "limits.h"
#include <fmt/format.h>

namespace lumel::gpu {
namespace {

// Collects the lines of one device.
class Complaints {
public:
    explicit Complaints(const std::string& device) : device_(device) {}
    void atMost(const char* limit, uint64_t offered, uint64_t needed, const std::string& remedy = {})
    {
        if (needed > offered)
            lines_.push_back(fmt::format("{} has {} {}, {} needed{}{}", device_, limit, offered, needed,
                                         remedy.empty() ? "" : ": ", remedy));
    }
    template<class Flags>
    void all(const char* limit, Flags offered, Flags needed)
    {
        if ((offered & needed) != needed)
            lines_.push_back(
                fmt::format("{} lacks {} in {}", device_, vk::to_string(needed & ~offered), limit));
    }
    std::vector<std::string> take() { return std::move(lines_); }

private:
    const std::string& device_;
    std::vector<std::string> lines_;
};

void checkShaders(Complaints& complaints, const Limits& limits, const Demands& demands)
{
    const vk::PhysicalDeviceLimits& core = limits.core;
    complaints.atMost("maxComputeWorkGroupInvocations", core.maxComputeWorkGroupInvocations,
                      demands.groupInvocations);
    complaints.atMost("maxComputeWorkGroupSize[0]", core.maxComputeWorkGroupSize[0], demands.groupWidth);
    complaints.atMost("maxComputeSharedMemorySize", core.maxComputeSharedMemorySize, demands.sharedBytes);
    complaints.atMost("maxPushConstantsSize", core.maxPushConstantsSize, demands.pushBytes);
    complaints.atMost("maxBoundDescriptorSets", core.maxBoundDescriptorSets, demands.sets);
    complaints.atMost("maxPerStageDescriptorSampledImages", core.maxPerStageDescriptorSampledImages,
                      demands.sampledImages);
    complaints.atMost("maxPerStageDescriptorSamplers", core.maxPerStageDescriptorSamplers,
                      demands.sampledImages); // each with its own
    complaints.atMost("maxPerStageDescriptorStorageImages", core.maxPerStageDescriptorStorageImages,
                      demands.storageImages);
    complaints.atMost("maxPerStageDescriptorUniformBuffers", core.maxPerStageDescriptorUniformBuffers,
                      demands.uniformBuffers);
    complaints.atMost("maxUniformBufferRange", core.maxUniformBufferRange, demands.uniformBytes);
    if (demands.computeSubgroups) {
        complaints.all("subgroupSupportedStages", limits.subgroupStages,
                       vk::ShaderStageFlags(vk::ShaderStageFlagBits::eCompute));
        complaints.all("subgroupSupportedOperations", limits.subgroupOperations, demands.computeSubgroups);
    }
}

} // namespace

Limits limitsOf(const vk::raii::PhysicalDevice& device, uint32_t queueFamily, const Demands& demands)
{
    const auto chain =
        device
            .getProperties2<vk::PhysicalDeviceProperties2, vk::PhysicalDeviceMaintenance3Properties,
                            vk::PhysicalDeviceMaintenance4Properties, vk::PhysicalDeviceSubgroupProperties>();
    const auto& properties = chain.get<vk::PhysicalDeviceProperties2>().properties;
    const auto& subgroups = chain.get<vk::PhysicalDeviceSubgroupProperties>();
    Limits limits{.device = properties.deviceName.data(),
                  .core = properties.limits,
                  .maxBufferSize = chain.get<vk::PhysicalDeviceMaintenance4Properties>().maxBufferSize,
                  .maxMemoryAllocationSize =
                      chain.get<vk::PhysicalDeviceMaintenance3Properties>().maxMemoryAllocationSize,
                  .subgroupSize = subgroups.subgroupSize,
                  .subgroupStages = subgroups.supportedStages,
                  .subgroupOperations = subgroups.supportedOperations,
                  .timestampValidBits = device.getQueueFamilyProperties()[queueFamily].timestampValidBits,
                  .formats = {}};
    const vk::PhysicalDeviceFeatures features = device.getFeatures();
    if (features.multiDrawIndirect && features.drawIndirectFirstInstance)
        limits.mostIndirectDraws = properties.limits.maxDrawIndirectCount;
    for (const FormatDemand& demand : demands.formats)
        limits.formats[demand.format] =
            device.getFormatProperties2<vk::FormatProperties2, vk::FormatProperties3>(demand.format)
                .get<vk::FormatProperties3>()
                .optimalTilingFeatures;
    return limits;
}

std::vector<std::string> unmet(const Limits& limits, const Demands& demands)
{
    Complaints complaints(limits.device);
    checkShaders(complaints, limits, demands);
    const vk::PhysicalDeviceLimits& core = limits.core;
    complaints.atMost("maxVertexInputAttributes", core.maxVertexInputAttributes, demands.vertexAttributes);
    complaints.atMost("maxVertexInputBindings", core.maxVertexInputBindings, demands.vertexBindings);
    complaints.atMost("maxVertexInputBindingStride", core.maxVertexInputBindingStride, demands.vertexStride);
    if (demands.vertexStride > 0) // of the last byte
        complaints.atMost("maxVertexInputAttributeOffset", core.maxVertexInputAttributeOffset,
                          demands.vertexStride - 1);
    complaints.all("framebufferColorSampleCounts", core.framebufferColorSampleCounts, demands.samples);
    complaints.all("framebufferDepthSampleCounts", core.framebufferDepthSampleCounts, demands.samples);
    if (demands.timestamps)
        complaints.atMost("timestampValidBits", limits.timestampValidBits, 1);
    for (const FormatDemand& demand : demands.formats) {
        const auto found = limits.formats.find(demand.format);
        complaints.all(fmt::format("{} ({})", vk::to_string(demand.format), demand.what).c_str(),
                       found == limits.formats.end() ? vk::FormatFeatureFlags2() : found->second,
                       demand.features);
    }
    return complaints.take();
}

std::vector<std::string> unmet(const std::string& device, const vk::ImageFormatProperties& properties,
                               const ImageDemand& demand)
{
    Complaints complaints(device);
    complaints.atMost("maxImageDimension2D",
                      std::min(properties.maxExtent.width, properties.maxExtent.height),
                      std::max(demand.width, demand.height), demand.remedy);
    complaints.atMost("maxImageArrayLayers", properties.maxArrayLayers, demand.layers, demand.remedy);
    complaints.atMost("maxMipLevels", properties.maxMipLevels, demand.mips, demand.remedy);
    complaints.all("sampleCounts", properties.sampleCounts, vk::SampleCountFlags(demand.samples));
    return complaints.take();
}

std::vector<std::string> unmet(const Limits& limits, vk::DeviceSize bytes, uint32_t count,
                               const std::string& remedy)
{
    Complaints complaints(limits.device);
    complaints.atMost("maxMemoryAllocationSize", limits.maxMemoryAllocationSize, bytes, remedy);
    complaints.atMost("maxMemoryAllocationCount", limits.core.maxMemoryAllocationCount, count,
                      "use a scene of fewer meshes and materials");
    return complaints.take();
}

} // namespace lumel::gpu
