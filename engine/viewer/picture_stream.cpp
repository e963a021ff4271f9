#include "picture_stream.h"
#include "gpu/barrier.h"

namespace lumel {
namespace {

constexpr auto kColour = vk::ImageAspectFlagBits::eColor;
constexpr vk::ImageSubresourceLayers kLayers{kColour, 0, 0, 1};

void fit(const gpu::Device& device, gpu::Image& image, vk::Extent2D size)
{
    const gpu::ImageInfo info{.format = vk::Format::eR8G8B8A8Unorm,
                              .width = size.width,
                              .height = size.height,
                              .usage = vk::ImageUsageFlagBits::eTransferSrc |
                                       vk::ImageUsageFlagBits::eTransferDst |
                                       vk::ImageUsageFlagBits::eSampled, // its view needs one such use
                              .remedy = "use a smaller window"};
    if (!image || !(image.info() == info))
        image = gpu::Image(device, info, "shown picture");
}

void fit(const gpu::Device& device, gpu::Buffer& buffer, size_t bytes, gpu::MemoryUsage usage)
{
    if (buffer.size() < bytes)
        buffer = gpu::Buffer(device, bytes, usage, "shown picture", "use a smaller window",
                             gpu::MemoryKind::staging);
}

size_t bytesOf(vk::Extent2D size)
{
    return size_t(size.width) * size.height * 4;
}

vk::BufferImageCopy wholeOf(vk::Extent2D size)
{
    return {.imageSubresource = kLayers, .imageExtent = {size.width, size.height, 1}};
}

} // namespace

void PictureStream::write(Renderer& from)
{
    copy(from);
    publish();
}

void PictureStream::fadeTo(Renderer& renderer, const std::function<bool()>& next)
{
    constexpr int kSteps = 6;
    const vk::Extent2D size = renderer.display().extent();
    const size_t bytes = bytesOf(size);
    std::vector<uint8_t> from;
    {
        const std::lock_guard lock(mutex_); // neither of the two is written to
        const Slot& last = slots_[fresh_ ? ready_ : shown_];
        if (throughHost() && last.size == size)
            from.assign(last.bytes.read<uint8_t>(), last.bytes.read<uint8_t>() + bytes);
    }
    copy(renderer);
    if (from.empty()) {
        publish();
        return;
    }
    const auto* exact = slots_[written_].bytes.read<uint8_t>();
    const std::vector<uint8_t> to(exact, exact + bytes);
    for (int step = 1; step < kSteps && next(); ++step) {
        Slot& slot = slots_[written_];
        slot.size = size;
        fit(renders_, slot.bytes, bytes, gpu::MemoryUsage::readback);
        auto* mixed = slot.bytes.mapped<uint8_t>();
        for (size_t i = 0; i < bytes; ++i)
            mixed[i] = uint8_t((from[i] * (kSteps - step) + to[i] * step) / kSteps);
        publish();
    }
    copy(renderer);
    publish();
}

// The window's commands come later on the same queue: nobody waits.
void PictureStream::copyOnDevice(Renderer& from, Slot& slot)
{
    if (!*slot.commands) {
        slot.commands = renders_.makeCommands();
        slot.fence = vk::raii::Fence(renders_.handle(), vk::FenceCreateInfo{});
    }
    if (std::exchange(slot.pending, false))
        renders_.wait(*slot.fence); // of a few frames ago
    fit(renders_, slot.image, slot.size);
    const vk::CommandBuffer commands = *slot.commands;
    commands.begin(vk::CommandBufferBeginInfo{.flags = vk::CommandBufferUsageFlagBits::eOneTimeSubmit});
    gpu::imageBarrier(commands, slot.image.handle(), kColour, gpu::Use::undefined, gpu::Use::transferWrite);
    commands.copyImage(from.display().handle(), vk::ImageLayout::eTransferSrcOptimal, slot.image.handle(),
                       vk::ImageLayout::eTransferDstOptimal,
                       vk::ImageCopy{.srcSubresource = kLayers,
                                     .dstSubresource = kLayers,
                                     .extent = {slot.size.width, slot.size.height, 1}});
    gpu::imageBarrier(commands, slot.image.handle(), kColour, gpu::Use::transferWrite,
                      gpu::Use::transferRead);
    commands.end();
    from.submitCopy(commands, *slot.fence);
    slot.pending = true;
}

void PictureStream::copy(Renderer& from)
{
    Slot& slot = slots_[written_];
    const gpu::Image& picture = from.display();
    slot.size = picture.extent();
    if (!throughHost()) {
        copyOnDevice(from, slot);
        return;
    }
    fit(renders_, slot.bytes, bytesOf(slot.size), gpu::MemoryUsage::readback);
    renders_.runOnce([&](vk::CommandBuffer commands) {
        commands.copyImageToBuffer(picture.handle(), vk::ImageLayout::eTransferSrcOptimal,
                                   slot.bytes.handle(), wholeOf(slot.size));
        gpu::memoryBarrier(commands, gpu::Use::transferWrite, gpu::Use::hostRead);
    });
}

void PictureStream::publish()
{
    const std::lock_guard lock(mutex_);
    std::swap(written_, ready_);
    fresh_ = true;
}

bool PictureStream::fresh() const
{
    const std::lock_guard lock(mutex_);
    return fresh_;
}

const gpu::Image* PictureStream::latest()
{
    bool fresh = false;
    {
        const std::lock_guard lock(mutex_);
        fresh = std::exchange(fresh_, false);
        if (fresh)
            std::swap(shown_, ready_);
        any_ = any_ || fresh;
    }
    if (!any_)
        return nullptr;
    if (!throughHost())
        return &slots_[shown_].image;
    if (fresh)
        upload(slots_[shown_]);
    return &uploaded_;
}

void PictureStream::upload(const Slot& slot)
{
    fit(shows_, staging_, bytesOf(slot.size), gpu::MemoryUsage::staging);
    std::memcpy(staging_.mapped<std::byte>(), slot.bytes.read<std::byte>(), bytesOf(slot.size));
    fit(shows_, uploaded_, slot.size);
    shows_.runOnce([&](vk::CommandBuffer commands) {
        gpu::imageBarrier(commands, uploaded_.handle(), kColour, gpu::Use::undefined,
                          gpu::Use::transferWrite);
        commands.copyBufferToImage(staging_.handle(), uploaded_.handle(),
                                   vk::ImageLayout::eTransferDstOptimal, wholeOf(slot.size));
        gpu::imageBarrier(commands, uploaded_.handle(), kColour, gpu::Use::transferWrite,
                          gpu::Use::transferRead);
    });
}

void PictureStream::forget()
{
    const std::lock_guard lock(mutex_);
    fresh_ = any_ = false;
}

} // namespace lumel
