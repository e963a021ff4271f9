#include "lit_pool.h"
#include "gpu/sampler.h"

namespace lumel {

LitPool::LitPool(const gpu::Device& device, size_t capBytes)
    : device_(device), pool_(capBytes),
      layout_(gpu::makeSetLayout(
          device, {vk::DescriptorType::eStorageImage, vk::DescriptorType::eCombinedImageSampler})),
      sampler_(gpu::makeSampler(device))
{
}

LitBlock LitPool::make(const tsl::PoolBlock& wanted) const
{
    LitBlock block;
    block.layout = tsl::TextureLayout(wanted.size);
    block.layers = uint32_t(wanted.textures.size());
    using Usage = vk::ImageUsageFlagBits;
    block.image =
        gpu::Image(device_,
                   {.width = block.layout.extent.x,
                    .height = block.layout.extent.y,
                    .layers = block.layers,
                    .usage = Usage::eStorage | Usage::eSampled | Usage::eTransferSrc | Usage::eTransferDst,
                    .arrayView = true,
                    .remedy = "use a smaller --pool-mb",
                    .kind = gpu::MemoryKind::litTextures},
                   "lit block");
    block.states = gpu::Buffer(device_, block.stateOffset(block.layers), gpu::Buffer::MemoryUsage::device,
                               "tile states", "use a smaller --pool-mb", gpu::MemoryKind::litTextures);
    block.set = gpu::makeSet(device_, layout_);
    gpu::writeStorage(device_, *block.set, 0, block.image.view());
    gpu::writeSampled(device_, *block.set, 1, *sampler_, block.image.view(), vk::ImageLayout::eGeneral);
    return block;
}

void LitPool::free(gpu::FrameRing& ring)
{
    size_t bytes = pool_.usedBytes();
    for (const auto& [lastUse, block] : givenUp_)
        bytes += lastUse > ring.finished() ? block.bytes() : 0;
    if (bytes > pool_.capBytes())
        ring.waitForAll();
    std::erase_if(givenUp_, [&](const auto& entry) { return entry.first <= ring.finished(); });
}

void LitPool::update(gpu::FrameRing& ring)
{
    const auto& wanted = pool_.blocks();
    blocks_.resize(wanted.size());
    prepared_.resize(wanted.size());
    // Free first, so that memory never passes the cap.
    const auto fits = [&](size_t i) {
        return blocks_[i].layout.size == wanted[i].size && blocks_[i].layers == wanted[i].textures.size();
    };
    for (size_t i = 0; i < wanted.size(); ++i)
        if (blocks_[i] && !fits(i)) {
            givenUp_.emplace_back(ring.submitted(), std::exchange(blocks_[i], {}));
            prepared_[i] = 0;
        }
    free(ring);
    for (size_t i = 0; i < wanted.size(); ++i)
        if (!wanted[i].textures.empty() && !blocks_[i])
            blocks_[i] = make(wanted[i]);
}

void LitPool::clear(size_t capBytes)
{
    pool_ = tsl::TexturePool(capBytes);
    blocks_.clear();
    givenUp_.clear();
    prepared_.clear();
}

void LitPool::recordTakeover(vk::CommandBuffer commands, const tsl::ObjectResidency& resident) const
{
    const LitBlock& to = block(resident.texture);
    const LitBlock& from = block(resident.previous);
    const auto fromLevel = int(pool_.texture(resident.previous).litLevel);
    for (uint32_t mip = 0; mip < to.layout.mips; ++mip) {
        const int source = int(resident.litLevel + mip) - fromLevel;
        if (source < 0 || source >= int(from.layout.mips))
            continue;
        const glm::uvec2 size = glm::max(to.layout.size >> mip, glm::uvec2(1));
        const auto corner = [](glm::uvec2 p) { return vk::Offset3D{int(p.x), int(p.y), 0}; };
        commands.copyImage(
            from.image.handle(), vk::ImageLayout::eGeneral, to.image.handle(), vk::ImageLayout::eGeneral,
            vk::ImageCopy{.srcSubresource = {vk::ImageAspectFlagBits::eColor, 0, resident.previous.layer, 1},
                          .srcOffset = corner(shared::mipOrigin(from.layout.size, uint32_t(source))),
                          .dstSubresource = {vk::ImageAspectFlagBits::eColor, 0, resident.texture.layer, 1},
                          .dstOffset = corner(shared::mipOrigin(to.layout.size, mip)),
                          .extent = {size.x, size.y, 1}});
        const auto place = [](const LitBlock& b, uint32_t layer, uint32_t m) {
            return b.stateOffset(layer) + b.layout.tileOffsets[m] * sizeof(shared::TileState);
        };
        const uint32_t last = mip + 1 < to.layout.mips ? to.layout.tileOffsets[mip + 1] : to.layout.tiles;
        commands.copyBuffer(from.states.handle(), to.states.handle(),
                            vk::BufferCopy{place(from, resident.previous.layer, uint32_t(source)),
                                           place(to, resident.texture.layer, mip),
                                           (last - to.layout.tileOffsets[mip]) * sizeof(shared::TileState)});
    }
}

void LitPool::recordHandovers(Frame& frame)
{
    const vk::CommandBuffer commands = frame.commands;
    for (size_t i = 0; i < blocks_.size(); ++i) {
        const gpu::Image& image = blocks_[i].image;
        if (image && !std::exchange(prepared_[i], uint8_t(1)))
            gpu::imageBarrier(commands, image.handle(), image.aspect(), gpu::Use::undefined,
                              gpu::Use::general);
    }
    bool any = false;
    for (const tsl::ObjectResidency& resident : frame.residency.objects())
        if (resident.fresh) {
            const LitBlock& b = block(resident.texture);
            // Drawing tells by a lumel's alpha whether it holds light: that of a former owner counts for
            // nothing. And memory of unknown content could be not-a-number, which no filter weight of 0
            // removes.
            commands.clearColorImage(
                b.image.handle(), vk::ImageLayout::eGeneral, vk::ClearColorValue{},
                vk::ImageSubresourceRange{b.image.aspect(), 0, 1, resident.texture.layer, 1});
            commands.fillBuffer(b.states.handle(), b.stateOffset(resident.texture.layer),
                                b.layout.tiles * sizeof(shared::TileState), 0);
            any = true;
        }
    if (!any)
        return;
    gpu::memoryBarrier(commands, gpu::Use::transferWrite, gpu::Use::transferWrite);
    for (const tsl::ObjectResidency& resident : frame.residency.objects())
        if (resident.fresh && resident.previous)
            recordTakeover(commands, resident);
    gpu::memoryBarrier(commands, gpu::Use::transferWrite, gpu::Use::general);
}

} // namespace lumel
