#include "sampler.h"

namespace lumel::gpu {

vk::raii::Sampler makeSampler(const Device& device, const SamplerInfo& info)
{
    return {device.handle(), vk::SamplerCreateInfo{.magFilter = info.filter,
                                                   .minFilter = info.filter,
                                                   .mipmapMode = info.mips ? vk::SamplerMipmapMode::eLinear
                                                                           : vk::SamplerMipmapMode::eNearest,
                                                   .addressModeU = info.u,
                                                   .addressModeV = info.v,
                                                   .maxLod = info.mips ? VK_LOD_CLAMP_NONE : 0.0f}};
}

vk::raii::Sampler makeShadowSampler(const Device& device)
{
    return {device.handle(),
            vk::SamplerCreateInfo{.magFilter = vk::Filter::eLinear,
                                  .minFilter = vk::Filter::eLinear,
                                  .addressModeU = vk::SamplerAddressMode::eClampToBorder,
                                  .addressModeV = vk::SamplerAddressMode::eClampToBorder,
                                  .compareEnable = VK_TRUE,
                                  .compareOp = vk::CompareOp::eGreaterOrEqual,
                                  .borderColor = vk::BorderColor::eFloatOpaqueBlack}}; // infinitely far
}

} // namespace lumel::gpu
