// The images behind tsl::TexturePool: a block is an array image, with its tiles' states and one descriptor
// set that lights, lowers and draws it.
#pragma once
#include "frame_context.h"

namespace lumel {

struct LitBlock {
    tsl::TextureLayout layout{glm::uvec2(1)};
    uint32_t layers = 0;
    gpu::Image image;
    gpu::Buffer states; // TileState, layer after layer
    vk::raii::DescriptorSet set = nullptr;

    explicit operator bool() const { return bool(image); }
    size_t bytes() const { return layout.layerBytes() * layers; }
    size_t stateOffset(uint32_t layer) const
    {
        return size_t(layer) * layout.tiles * sizeof(shared::TileState);
    }
};

class LitPool {
public:
    LitPool(const gpu::Device& device, size_t capBytes);

    tsl::TexturePool& bookkeeping() { return pool_; }
    const tsl::TexturePool& bookkeeping() const { return pool_; }
    // Makes and frees blocks so that they match the bookkeeping. What frames in flight may use is freed once
    // they have finished; where memory would pass the cap by then, this waits for them.
    void update(gpu::FrameRing& ring);
    // Gives all textures up. Call when no frame is in flight.
    void clear(size_t capBytes);
    // Empties textures that changed hands, taking over lumels of levels that the owner had lit before.
    void recordHandovers(Frame& frame);

    const std::vector<LitBlock>& blocks() const { return blocks_; }
    const LitBlock& block(tsl::TextureId id) const { return blocks_[size_t(id.block)]; }
    // Binding 0: storage image, 1: sampled.
    const gpu::SetLayout& layout() const { return layout_; }

private:
    LitBlock make(const tsl::PoolBlock& wanted) const;
    void free(gpu::FrameRing& ring);
    void recordTakeover(vk::CommandBuffer commands, const tsl::ObjectResidency& resident) const;
    const gpu::Device& device_;
    tsl::TexturePool pool_;
    gpu::SetLayout layout_;
    vk::raii::Sampler sampler_;
    std::vector<LitBlock> blocks_;                       // parallel to the bookkeeping's
    std::vector<uint8_t> prepared_;                      // block has left the undefined layout
    std::vector<std::pair<uint64_t, LitBlock>> givenUp_; // with the last submission that may use it
};

} // namespace lumel
