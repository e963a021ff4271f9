#include "demands.h"
#include "renderer/passes/shadow_pass.h"
#include "renderer/passes/vertex_input.h"
#include "renderer/resources/targets.h"
#include <algorithm>
#include <cstdlib>

namespace lumel {
namespace {

using Feature = vk::FormatFeatureFlagBits2;

// Images of these formats, in everything that any pass does with them.
std::vector<gpu::FormatDemand> formatDemands()
{
    const vk::FormatFeatureFlags2 filtered = Feature::eSampledImage | Feature::eSampledImageFilterLinear;
    const vk::FormatFeatureFlags2 copied = Feature::eTransferSrc | Feature::eTransferDst;
    return {{vk::Format::eR16G16B16A16Sfloat,
             filtered | copied | Feature::eStorageImage | Feature::eColorAttachment |
                 Feature::eColorAttachmentBlend,
             "radiance and lit textures"},
            // Samplers that compare may filter bilinearly whatever eSampledImageFilterLinear says, which
            // Mesa's lavapipe leaves out (Vulkan 1.3, VUID-vkCmdDispatch-magFilter-04553 and -None-06479).
            {vk::Format::eD32Sfloat,
             Feature::eSampledImage | Feature::eSampledImageDepthComparison |
                 Feature::eDepthStencilAttachment | Feature::eTransferDst,
             "shadow maps"},
            {vk::Format::eR32G32B32A32Uint,
             Feature::eColorAttachment | Feature::eSampledImage | Feature::eStorageImage,
             "what the feedback pass sees"},
            {vk::Format::eR32G32B32A32Sfloat, Feature::eSampledImage | copied | Feature::eStorageImage,
             "the reference's sum"},
            {vk::Format::eR8G8B8A8Unorm, Feature::eStorageImage | Feature::eTransferSrc, "the display"}};
}

} // namespace

gpu::Demands rendererDemands()
{
    return {
        .groupInvocations = 64, // every compute shader's local_size_x
        .groupWidth = 64,
        .sharedBytes = shared::kElongations * sizeof(uint32_t), // feedback.comp
        .pushBytes = uint32_t(
            std::max({sizeof(shared::LitPush), sizeof(shared::PlanPush), sizeof(shared::FeedbackPush),
                      sizeof(shared::ShadowPush), sizeof(shared::DeformPush), sizeof(shared::ForwardPush)})),
        .sets = 4,           // light.comp: the frame's, the material's, the lit texture's, the vertices'
        .sampledImages = 12, // of these: environment and shadow maps, the object table, eight maps, vertices
        .storageImages = 2,  // accumulate.comp
        .uniformBuffers = 2,
        .uniformBytes = uint32_t(std::max(sizeof(shared::View), shared::kMaxLights * sizeof(shared::Light))),
        .vertexAttributes = shared::kAttributeWorldNormal + 3, // three columns
        .vertexBindings = uint32_t(kMeshBindings.size()),
        .vertexStride = uint32_t(std::max(sizeof(shared::Vertex), sizeof(shared::Object))),
        .samples = vk::SampleCountFlagBits::e1 | vk::SampleCountFlagBits::e4, // --msaa
        // lib/light_tiles.glsl adds the changes of a tile's lumels up; subgroups may have any size.
        .computeSubgroups = vk::SubgroupFeatureFlagBits::eBasic | vk::SubgroupFeatureFlagBits::eArithmetic,
        .timestamps = true,
        .formats = formatDemands()};
}

gpu::DeviceOptions forRendering(gpu::DeviceOptions options)
{
    options.demands = rendererDemands();
    options.stage = options.stage || std::getenv("LUMEL_STAGE"); // for tests, see tests/README.md
    return options;
}

void checkSizes(const gpu::Device& device, const Settings& settings)
{
    Targets::check(device, settings);
    if (settings.shadows)
        gpu::checkImage(device, shadowMapInfo(settings.shadowSize, 1));
}

} // namespace lumel
