// How a resource is used, in one table: stage, access and image layout. Raw masks live nowhere else.
#pragma once
#include <vulkan/vulkan_raii.hpp>

namespace lumel::gpu {

enum class Use {
    undefined, // contents do not matter
    transferRead,
    transferWrite,
    computeRead, // storage image or buffer
    computeWrite,
    computeReadWrite,
    computeSample, // sampled image
    shaderSample,  // sampled image, by compute and fragment shaders
    colorWrite,
    depthWrite,
    hostRead,
    indirectRead, // dispatch arguments
    acquired,     // a window's image from its semaphore on; contents do not matter
    present,      // by the window
    general,      // an image or buffer that any command may read and write
};

struct UseMasks {
    vk::PipelineStageFlags2 stage;
    vk::AccessFlags2 access;
    vk::ImageLayout layout;
};
UseMasks masksOf(Use use);

// All mips and layers of an image.
vk::ImageMemoryBarrier2 makeImageBarrier(vk::Image image, vk::ImageAspectFlags aspect, Use from, Use to);
void imageBarrier(vk::CommandBuffer commands, vk::Image image, vk::ImageAspectFlags aspect, Use from, Use to);
// Everything else: buffers, and images that keep their layout.
vk::MemoryBarrier2 makeMemoryBarrier(Use from, Use to);
void memoryBarrier(vk::CommandBuffer commands, Use from, Use to);

} // namespace lumel::gpu
