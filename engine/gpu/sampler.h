// Samplers from a plain description.
#pragma once
#include "device.h"

namespace lumel::gpu {

struct SamplerInfo {
    vk::Filter filter = vk::Filter::eLinear;
    vk::SamplerAddressMode u = vk::SamplerAddressMode::eClampToEdge;
    vk::SamplerAddressMode v = vk::SamplerAddressMode::eClampToEdge;
    bool mips = false; // all of them, trilinear; else level 0 alone
};
vk::raii::Sampler makeSampler(const Device& device, const SamplerInfo& info = {});

// Four bilinear comparisons with reversed depth: 1 where nothing is nearer to the light. Beyond the map
// nothing is.
vk::raii::Sampler makeShadowSampler(const Device& device);

} // namespace lumel::gpu
