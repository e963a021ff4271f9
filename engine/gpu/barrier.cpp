#include "barrier.h"

namespace lumel::gpu {

UseMasks masksOf(Use use)
{
    using Stage = vk::PipelineStageFlagBits2;
    using Access = vk::AccessFlagBits2;
    using Layout = vk::ImageLayout;
    const auto depthStages = Stage::eEarlyFragmentTests | Stage::eLateFragmentTests;
    switch (use) {
    case Use::undefined:
        return {Stage::eNone, Access::eNone, Layout::eUndefined};
    case Use::transferRead:
        return {Stage::eTransfer, Access::eTransferRead, Layout::eTransferSrcOptimal};
    case Use::transferWrite:
        return {Stage::eTransfer, Access::eTransferWrite, Layout::eTransferDstOptimal};
    case Use::computeRead:
        return {Stage::eComputeShader, Access::eShaderStorageRead, Layout::eGeneral};
    case Use::computeWrite:
        return {Stage::eComputeShader, Access::eShaderStorageWrite, Layout::eGeneral};
    case Use::computeReadWrite:
        return {Stage::eComputeShader, Access::eShaderStorageRead | Access::eShaderStorageWrite,
                Layout::eGeneral};
    case Use::computeSample:
        return {Stage::eComputeShader, Access::eShaderSampledRead, Layout::eShaderReadOnlyOptimal};
    case Use::shaderSample:
        return {Stage::eComputeShader | Stage::eFragmentShader, Access::eShaderSampledRead,
                Layout::eShaderReadOnlyOptimal};
    case Use::colorWrite:
        return {Stage::eColorAttachmentOutput, Access::eColorAttachmentRead | Access::eColorAttachmentWrite,
                Layout::eColorAttachmentOptimal};
    case Use::depthWrite:
        return {depthStages, Access::eDepthStencilAttachmentRead | Access::eDepthStencilAttachmentWrite,
                Layout::eDepthAttachmentOptimal};
    case Use::acquired: // the wait for the semaphore is at this stage
        return {Stage::eTransfer, Access::eNone, Layout::eUndefined};
    case Use::present: // the semaphore carries the rest
        return {Stage::eNone, Access::eNone, Layout::ePresentSrcKHR};
    case Use::hostRead:
        return {Stage::eHost, Access::eHostRead, Layout::eGeneral};
    case Use::indirectRead:
        return {Stage::eDrawIndirect | Stage::eComputeShader,
                Access::eIndirectCommandRead | Access::eShaderStorageRead | Access::eShaderStorageWrite,
                Layout::eGeneral};
    case Use::general:
        return {Stage::eAllCommands, Access::eMemoryRead | Access::eMemoryWrite, Layout::eGeneral};
    }
    return {};
}

vk::ImageMemoryBarrier2 makeImageBarrier(vk::Image image, vk::ImageAspectFlags aspect, Use from, Use to)
{
    const UseMasks a = masksOf(from), b = masksOf(to);
    // An image whose contents do not matter may still be in use by the previous frame's commands: wait for
    // whatever the new use would collide with.
    return {.srcStageMask = from == Use::undefined ? vk::PipelineStageFlagBits2::eAllCommands : a.stage,
            .srcAccessMask = from == Use::undefined ? vk::AccessFlagBits2::eMemoryWrite : a.access,
            .dstStageMask = b.stage,
            .dstAccessMask = b.access,
            .oldLayout = a.layout,
            .newLayout = b.layout,
            .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
            .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
            .image = image,
            .subresourceRange = {aspect, 0, VK_REMAINING_MIP_LEVELS, 0, VK_REMAINING_ARRAY_LAYERS}};
}

void imageBarrier(vk::CommandBuffer commands, vk::Image image, vk::ImageAspectFlags aspect, Use from, Use to)
{
    const vk::ImageMemoryBarrier2 barrier = makeImageBarrier(image, aspect, from, to);
    commands.pipelineBarrier2(
        vk::DependencyInfo{.imageMemoryBarrierCount = 1, .pImageMemoryBarriers = &barrier});
}

vk::MemoryBarrier2 makeMemoryBarrier(Use from, Use to)
{
    const UseMasks a = masksOf(from), b = masksOf(to);
    return {.srcStageMask = a.stage,
            .srcAccessMask = a.access,
            .dstStageMask = b.stage,
            .dstAccessMask = b.access};
}

void memoryBarrier(vk::CommandBuffer commands, Use from, Use to)
{
    const vk::MemoryBarrier2 barrier = makeMemoryBarrier(from, to);
    commands.pipelineBarrier2(vk::DependencyInfo{.memoryBarrierCount = 1, .pMemoryBarriers = &barrier});
}

} // namespace lumel::gpu
