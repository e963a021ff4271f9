// Which limits make a device unsuitable, checked on invented limits: no device is queried.
#include "gpu/limits.h"
#include "renderer/demands.h"
#include "shared/structs.h"
#include <functional>
#include <gtest/gtest.h>

using namespace lumel;

namespace {

// A device that has exactly what is asked for.
gpu::Limits justEnough(const gpu::Demands& demands)
{
    gpu::Limits limits;
    limits.device = "Tiny";
    limits.core.maxComputeWorkGroupInvocations = demands.groupInvocations;
    limits.core.maxComputeWorkGroupSize[0] = demands.groupWidth;
    limits.core.maxComputeSharedMemorySize = demands.sharedBytes;
    limits.core.maxPushConstantsSize = demands.pushBytes;
    limits.core.maxBoundDescriptorSets = demands.sets;
    limits.core.maxPerStageDescriptorSampledImages = demands.sampledImages;
    limits.core.maxPerStageDescriptorSamplers = demands.sampledImages;
    limits.core.maxPerStageDescriptorStorageImages = demands.storageImages;
    limits.core.maxPerStageDescriptorUniformBuffers = demands.uniformBuffers;
    limits.core.maxUniformBufferRange = demands.uniformBytes;
    limits.core.maxVertexInputAttributes = demands.vertexAttributes;
    limits.core.maxVertexInputBindings = demands.vertexBindings;
    limits.core.maxVertexInputBindingStride = demands.vertexStride;
    limits.core.maxVertexInputAttributeOffset = demands.vertexStride;
    limits.core.framebufferColorSampleCounts = demands.samples;
    limits.core.framebufferDepthSampleCounts = demands.samples;
    limits.core.maxMemoryAllocationCount = 100;
    limits.maxMemoryAllocationSize = 1000;
    limits.subgroupStages = vk::ShaderStageFlagBits::eCompute;
    limits.subgroupOperations = demands.computeSubgroups;
    limits.timestampValidBits = 36;
    for (const gpu::FormatDemand& format : demands.formats)
        limits.formats[format.format] |= format.features;
    return limits;
}

} // namespace

TEST(Limits, WhatIsJustEnoughIsEnough)
{
    EXPECT_EQ(gpu::unmet(justEnough(rendererDemands()), rendererDemands()), std::vector<std::string>{});
}

// Every demand of the renderer is within what Vulkan 1.3 requires of all devices, but the size of the table
// of lights and what is not required at all: subgroups that add, and timestamps.
TEST(Limits, DemandsAreModest)
{
    const gpu::Demands demands = rendererDemands();
    EXPECT_LE(demands.groupInvocations, 128u);
    EXPECT_LE(demands.sharedBytes, 16384u);
    EXPECT_LE(demands.pushBytes, 128u);
    EXPECT_LE(demands.sets, 4u);
    EXPECT_LE(demands.sampledImages, 16u);
    EXPECT_LE(demands.storageImages, 4u);
    EXPECT_LE(demands.vertexAttributes, 16u);
    EXPECT_LE(demands.vertexStride, 2048u);
    EXPECT_LE(demands.uniformBytes, 65536u);
}

TEST(Limits, EachThatIsTooSmallIsNamed)
{
    const gpu::Demands demands = rendererDemands();
    using Format = vk::Format;
    using Feature = vk::FormatFeatureFlagBits2;
    const std::pair<const char*, std::function<void(gpu::Limits&)>> cases[] = {
        {"maxComputeWorkGroupInvocations 32, 64 needed",
         [](auto& l) { l.core.maxComputeWorkGroupInvocations = 32; }},
        {"maxComputeWorkGroupSize[0] 63", [](auto& l) { l.core.maxComputeWorkGroupSize[0] = 63; }},
        {"maxComputeSharedMemorySize 16", [](auto& l) { l.core.maxComputeSharedMemorySize = 16; }},
        {"maxPushConstantsSize 64", [](auto& l) { l.core.maxPushConstantsSize = 64; }},
        {"maxBoundDescriptorSets 2, 4 needed", [](auto& l) { l.core.maxBoundDescriptorSets = 2; }},
        {"maxPerStageDescriptorSampledImages 4",
         [](auto& l) { l.core.maxPerStageDescriptorSampledImages = 4; }},
        {"maxPerStageDescriptorSamplers 4", [](auto& l) { l.core.maxPerStageDescriptorSamplers = 4; }},
        {"maxPerStageDescriptorStorageImages 1",
         [](auto& l) { l.core.maxPerStageDescriptorStorageImages = 1; }},
        {"maxPerStageDescriptorUniformBuffers 1",
         [](auto& l) { l.core.maxPerStageDescriptorUniformBuffers = 1; }},
        {"maxUniformBufferRange 16384, 57344 needed", [](auto& l) { l.core.maxUniformBufferRange = 16384; }},
        {"maxVertexInputAttributes 8, 12 needed", [](auto& l) { l.core.maxVertexInputAttributes = 8; }},
        {"maxVertexInputBindings 1", [](auto& l) { l.core.maxVertexInputBindings = 1; }},
        {"maxVertexInputBindingStride 64", [](auto& l) { l.core.maxVertexInputBindingStride = 64; }},
        {"maxVertexInputAttributeOffset 64", [](auto& l) { l.core.maxVertexInputAttributeOffset = 64; }},
        {"4 } in framebufferColorSampleCounts",
         [](auto& l) { l.core.framebufferColorSampleCounts = vk::SampleCountFlagBits::e1; }},
        {"4 } in framebufferDepthSampleCounts",
         [](auto& l) { l.core.framebufferDepthSampleCounts = vk::SampleCountFlagBits::e1; }},
        {"Compute } in subgroupSupportedStages",
         [](auto& l) { l.subgroupStages = vk::ShaderStageFlagBits::eFragment; }},
        {"Arithmetic } in subgroupSupportedOperations",
         [](auto& l) { l.subgroupOperations = vk::SubgroupFeatureFlagBits::eBasic; }},
        {"timestampValidBits 0", [](auto& l) { l.timestampValidBits = 0; }},
        {"SampledImageDepthComparison } in D32Sfloat (shadow maps",
         [](auto& l) { l.formats[Format::eD32Sfloat] &= ~Feature::eSampledImageDepthComparison; }},
        {"SampledImageFilterLinear } in R16G16B16A16Sfloat",
         [](auto& l) { l.formats[Format::eR16G16B16A16Sfloat] &= ~Feature::eSampledImageFilterLinear; }},
        {"ColorAttachmentBlend } in R16G16B16A16Sfloat (radiance",
         [](auto& l) { l.formats[Format::eR16G16B16A16Sfloat] &= ~Feature::eColorAttachmentBlend; }},
        {"StorageImage", [](auto& l) { l.formats.erase(Format::eR32G32B32A32Uint); }}};
    for (const auto& [words, shrink] : cases) {
        gpu::Limits limits = justEnough(demands);
        shrink(limits);
        const std::vector<std::string> lines = gpu::unmet(limits, demands);
        ASSERT_EQ(lines.size(), 1u) << words;
        EXPECT_EQ(lines.front().rfind("Tiny ", 0), 0u) << lines.front();
        EXPECT_NE(lines.front().find(words), std::string::npos) << lines.front();
    }
}

TEST(Limits, ImagesTooLargeSayWhatToUseInstead)
{
    const vk::ImageFormatProperties properties{.maxExtent = {4096, 4096, 1},
                                               .maxMipLevels = 13,
                                               .maxArrayLayers = 256,
                                               .sampleCounts = vk::SampleCountFlagBits::e1,
                                               .maxResourceSize = 1u << 31};
    const gpu::ImageDemand fits{.width = 4096, .height = 4096, .layers = 256, .mips = 13, .remedy = {}};
    EXPECT_EQ(gpu::unmet("Tiny", properties, fits), std::vector<std::string>{});
    EXPECT_EQ(
        gpu::unmet("Tiny", properties, {.width = 7680, .height = 4320, .remedy = "use a smaller --size"}),
        std::vector<std::string>{"Tiny has maxImageDimension2D 4096, 7680 needed: use a smaller --size"});
    EXPECT_EQ(gpu::unmet("Tiny", properties, {.layers = 257, .remedy = "use fewer"}),
              std::vector<std::string>{"Tiny has maxImageArrayLayers 256, 257 needed: use fewer"});
    EXPECT_EQ(gpu::unmet("Tiny", properties, {.samples = vk::SampleCountFlagBits::e4, .remedy = {}}),
              std::vector<std::string>{"Tiny lacks { 4 } in sampleCounts"});
}

TEST(Limits, MemoryIsLimitedInSizeAndNumber)
{
    const gpu::Limits limits = justEnough({});
    EXPECT_EQ(gpu::unmet(limits, 1000, 100, "use less"), std::vector<std::string>{});
    EXPECT_EQ(gpu::unmet(limits, 1001, 1, "use less"),
              std::vector<std::string>{"Tiny has maxMemoryAllocationSize 1000, 1001 needed: use less"});
    EXPECT_EQ(gpu::unmet(limits, 1, 101, "use less"),
              std::vector<std::string>{"Tiny has maxMemoryAllocationCount 100, 101 needed: "
                                       "use a scene of fewer meshes and materials"});
}

// A row holds what every device takes; all that is asked for is covered, and little more.
TEST(Limits, DispatchesOverListsKeepToTheGroupsThatEveryDeviceTakes)
{
    for (const uint32_t invocations :
         {0u, 1u, 64u, 65u, 3840u * 2160u, 7680u * 4320u, 8192u * 8192u, 64u * 65535u, 64u * 65535u + 1u}) {
        const glm::uvec2 groups = shared::groupRows(invocations);
        EXPECT_LE(groups.x, 65535u) << invocations;
        EXPECT_LE(groups.y, 65535u) << invocations;
        EXPECT_GE(uint64_t(groups.x) * groups.y * 64, invocations);
        EXPECT_LT((uint64_t(groups.x) * groups.y - groups.y) * 64, std::max(invocations, 1u));
    }
    EXPECT_EQ(shared::groupRows(64u * 65535u), glm::uvec2(65535, 1));
}
