#include "frame_set.h"
#include "gpu/barrier.h"
#include "gpu/sampler.h"

namespace lumel {

FrameSet::FrameSet(const gpu::Device& device, size_t objects)
    : device_(device),
      layout_(gpu::makeSetLayout(
          device, {vk::DescriptorType::eUniformBuffer, vk::DescriptorType::eUniformBuffer,
                   vk::DescriptorType::eCombinedImageSampler, vk::DescriptorType::eCombinedImageSampler,
                   vk::DescriptorType::eUniformTexelBuffer})),
      environmentSampler_(gpu::makeSampler(device, {.mips = true})),
      objectBytes_(objects * sizeof(shared::Object))
{
    begin(0);
}

void FrameSet::begin(uint32_t place)
{
    place_ = place;
    Place& p = current();
    if (*p.set)
        return;
    constexpr auto kUsage = gpu::Buffer::MemoryUsage::host;
    p.set = gpu::makeSet(device_, layout_);
    p.view = gpu::Buffer(device_, sizeof(shared::View), kUsage, "view");
    p.lights = gpu::Buffer(device_, shared::kMaxLights * sizeof(shared::Light), kUsage, "lights");
    p.objects = gpu::Buffer(device_, objectBytes_, kUsage, "objects");
    p.objectTexels = gpu::makeTexelView(device_, p.objects);
    gpu::writeUniform(device_, *p.set, 0, p.view.handle());
    gpu::writeUniform(device_, *p.set, 1, p.lights.handle());
    gpu::writeTexels(device_, *p.set, 4, *p.objectTexels);
    bindMaps(p);
}

void FrameSet::recordView(vk::CommandBuffer commands, const shared::View& view) const
{
    gpu::memoryBarrier(commands, gpu::Use::general, gpu::Use::transferWrite);
    commands.updateBuffer<shared::View>(viewBuffer(), 0, view);
    gpu::memoryBarrier(commands, gpu::Use::transferWrite, gpu::Use::general);
}

void FrameSet::bindMaps(const Place& place) const
{
    if (environment_)
        gpu::writeSampled(device_, *place.set, 2, *environmentSampler_, environment_);
    if (shadows_)
        gpu::writeSampled(device_, *place.set, 3, shadowSampler_, shadows_);
}

void FrameSet::bindEnvironment(vk::ImageView map)
{
    environment_ = map;
    for (const Place& place : places_)
        if (*place.set)
            bindMaps(place);
}

void FrameSet::bindShadows(vk::Sampler sampler, vk::ImageView maps)
{
    shadows_ = maps;
    shadowSampler_ = sampler;
    for (const Place& place : places_)
        if (*place.set)
            bindMaps(place);
}

} // namespace lumel
