// The images behind tsl::TexturePool, with the descriptor sets that light, filter and draw them.
#pragma once
#include "frame_context.h"

namespace lumel {

struct LitTexture {
    gpu::Image image;
    vk::raii::DescriptorSet lightSet = nullptr;     // MIP 0 as storage image
    std::vector<vk::raii::DescriptorSet> lowerSets; // [i]: MIP i read, MIP i + 1 written
    vk::raii::DescriptorSet drawSet = nullptr;      // all MIPs sampled
    bool written = false;                           // has left the undefined layout
};

class LitPool {
public:
    LitPool(const gpu::Device& device, size_t capBytes);

    tsl::TexturePool& bookkeeping() { return pool_; }
    // Makes and frees images so that they match the bookkeeping. Call when no frame is in flight.
    void update();
    LitTexture& texture(int index) { return textures_[size_t(index)]; }

    const gpu::SetLayout& lightLayout() const { return lightLayout_; }
    const gpu::SetLayout& lowerLayout() const { return lowerLayout_; }
    const gpu::SetLayout& drawLayout() const { return drawLayout_; }

private:
    LitTexture make(glm::uvec2 size) const;
    const gpu::Device& device_;
    tsl::TexturePool pool_;
    gpu::SetLayout lightLayout_, lowerLayout_, drawLayout_;
    vk::raii::Sampler sampler_;
    std::vector<LitTexture> textures_; // parallel to the bookkeeping's slots
};

} // namespace lumel
