#include "frame_set.h"
#include "gpu/barrier.h"
#include "gpu/sampler.h"

namespace lumel {

FrameSet::FrameSet(const gpu::Device& device)
    : layout_(gpu::makeSetLayout(
          device, {vk::DescriptorType::eUniformBuffer, vk::DescriptorType::eUniformBuffer,
                   vk::DescriptorType::eCombinedImageSampler, vk::DescriptorType::eCombinedImageSampler,
                   vk::DescriptorType::eUniformTexelBuffer})),
      set_(gpu::makeSet(device, layout_)), environmentSampler_(gpu::makeSampler(device, {.mips = true})),
      view_(device, sizeof(shared::View), gpu::Buffer::MemoryUsage::host, "view"),
      lights_(device, shared::kMaxLights * sizeof(shared::Light), gpu::Buffer::MemoryUsage::host, "lights")
{
    gpu::writeUniform(device, *set_, 0, view_.handle());
    gpu::writeUniform(device, *set_, 1, lights_.handle());
}

void FrameSet::recordView(vk::CommandBuffer commands, const shared::View& view) const
{
    gpu::memoryBarrier(commands, gpu::Use::general, gpu::Use::transferWrite);
    commands.updateBuffer<shared::View>(view_.handle(), 0, view);
    gpu::memoryBarrier(commands, gpu::Use::transferWrite, gpu::Use::general);
}

void FrameSet::bindEnvironment(const gpu::Device& device, vk::ImageView map)
{
    gpu::writeSampled(device, *set_, 2, *environmentSampler_, map);
}

void FrameSet::bindObjects(const gpu::Device& device, vk::BufferView table)
{
    gpu::writeTexels(device, *set_, 4, table);
}

void FrameSet::bindShadows(const gpu::Device& device, vk::Sampler sampler, vk::ImageView maps)
{
    gpu::writeSampled(device, *set_, 3, sampler, maps);
}

} // namespace lumel
