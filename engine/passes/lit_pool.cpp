#include "lit_pool.h"
#include <bit>

namespace lumel {

LitPool::LitPool(const gpu::Device& device, size_t capBytes)
    : device_(device), pool_(capBytes),
      lightLayout_(gpu::makeSetLayout(device, {vk::DescriptorType::eStorageImage})),
      lowerLayout_(
          gpu::makeSetLayout(device, {vk::DescriptorType::eStorageImage, vk::DescriptorType::eStorageImage})),
      drawLayout_(gpu::makeSetLayout(device, {vk::DescriptorType::eCombinedImageSampler})),
      sampler_(device.handle(),
               {.magFilter = vk::Filter::eLinear,
                .minFilter = vk::Filter::eLinear,
                .mipmapMode = vk::SamplerMipmapMode::eNearest, // levels are blended in the shader
                .addressModeU = vk::SamplerAddressMode::eClampToEdge,
                .addressModeV = vk::SamplerAddressMode::eClampToEdge,
                .maxLod = VK_LOD_CLAMP_NONE})
{
}

LitTexture LitPool::make(glm::uvec2 size) const
{
    LitTexture texture;
    const auto mips = uint32_t(std::bit_width(std::max(size.x, size.y)));
    texture.image = gpu::Image(device_,
                               {.width = size.x,
                                .height = size.y,
                                .mips = mips,
                                .usage = vk::ImageUsageFlagBits::eStorage | vk::ImageUsageFlagBits::eSampled,
                                .arrayView = true},
                               "lit texture");
    texture.lightSet = gpu::makeSet(device_, lightLayout_);
    gpu::writeStorage(device_, *texture.lightSet, 0, texture.image.mipView(0));
    for (uint32_t mip = 0; mip + 1 < mips; ++mip) {
        texture.lowerSets.push_back(gpu::makeSet(device_, lowerLayout_));
        gpu::writeStorage(device_, *texture.lowerSets.back(), 0, texture.image.mipView(mip));
        gpu::writeStorage(device_, *texture.lowerSets.back(), 1, texture.image.mipView(mip + 1));
    }
    texture.drawSet = gpu::makeSet(device_, drawLayout_);
    gpu::writeSampled(device_, *texture.drawSet, 0, *sampler_, texture.image.view());
    return texture;
}

void LitPool::update()
{
    const auto& slots = pool_.textures();
    textures_.resize(slots.size());
    // Free first, so that memory never passes the cap.
    const auto fits = [&](size_t i) {
        return slots[i].alive && textures_[i].image && textures_[i].image.info().width == slots[i].size.x &&
               textures_[i].image.info().height == slots[i].size.y;
    };
    for (size_t i = 0; i < slots.size(); ++i)
        if (textures_[i].image && !fits(i))
            textures_[i] = {};
    for (size_t i = 0; i < slots.size(); ++i)
        if (slots[i].alive && !fits(i))
            textures_[i] = make(slots[i].size);
}

} // namespace lumel
