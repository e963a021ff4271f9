#include "resource.h"
#include "barrier.h"
#include "core/error.h"
#include <algorithm>
#include <fmt/format.h>

namespace lumel::gpu {

Buffer::Buffer(const Device& device, size_t bytes, MemoryUsage memoryUsage, const std::string& name,
               const std::string& remedy)
    : size_(std::max<size_t>(bytes, 16))
{
    if (size_ > device.limits().maxBufferSize)
        throw Error(fmt::format("Vulkan: {} has maxBufferSize {}, {} needed: {}", device.limits().device,
                                device.limits().maxBufferSize, size_, remedy));
    using Usage = vk::BufferUsageFlagBits;
    buffer_ = vk::raii::Buffer(
        device.handle(), {.size = size_,
                          .usage = Usage::eStorageBuffer | Usage::eIndirectBuffer | Usage::eIndexBuffer |
                                   Usage::eVertexBuffer | Usage::eUniformBuffer | Usage::eUniformTexelBuffer |
                                   Usage::eTransferSrc | Usage::eTransferDst | Usage::eShaderDeviceAddress});
    using Property = vk::MemoryPropertyFlagBits;
    const auto wanted = memoryUsage == MemoryUsage::host ? Property::eHostVisible | Property::eHostCoherent
                                                         : vk::MemoryPropertyFlags(Property::eDeviceLocal);
    memory_ = device.allocate(buffer_.getMemoryRequirements(), wanted, remedy, true);
    buffer_.bindMemory(*memory_.handle, 0);
    address_ = device.handle().getBufferAddress({.buffer = *buffer_});
    if (memory_.seenByHost)
        mapped_ = memory_.handle.mapMemory(0, size_);
    device.name(buffer_, name);
}

vk::raii::BufferView makeTexelView(const Device& device, const Buffer& buffer)
{
    const size_t texels = buffer.size() / (4 * sizeof(uint32_t)),
                 most = device.limits().core.maxTexelBufferElements;
    if (texels > most)
        throw Error(fmt::format("Vulkan: {} has maxTexelBufferElements {}, {} needed: use a smaller scene",
                                device.limits().device, most, texels));
    return {device.handle(),
            {.buffer = buffer.handle(), .format = vk::Format::eR32G32B32A32Uint, .range = VK_WHOLE_SIZE}};
}

void recordUpload(vk::CommandBuffer commands, const Buffer& staging, const Buffer& to)
{
    commands.copyBuffer(staging.handle(), to.handle(),
                        vk::BufferCopy{.size = std::min(staging.size(), to.size())});
    memoryBarrier(commands, Use::transferWrite, Use::general);
}

void recordUpload(vk::CommandBuffer commands, const Buffer& staging, const Image& to,
                  const std::vector<vk::BufferImageCopy>& mips)
{
    imageBarrier(commands, to.handle(), to.aspect(), Use::undefined, Use::transferWrite);
    commands.copyBufferToImage(staging.handle(), to.handle(), vk::ImageLayout::eTransferDstOptimal, mips);
    imageBarrier(commands, to.handle(), to.aspect(), Use::transferWrite, Use::shaderSample);
}

Buffer uploadBuffer(const Device& device, std::span<const std::byte> data, const std::string& name)
{
    Buffer buffer(device, data.size(), Buffer::MemoryUsage::device, name);
    if (data.empty())
        return buffer;
    if (buffer.mapped<void>()) { // memory that both share: submitting makes it visible
        std::memcpy(buffer.mapped<void>(), data.data(), data.size());
        return buffer;
    }
    const Buffer staging(device, data.size(), Buffer::MemoryUsage::host, name + " (staging)");
    std::memcpy(staging.mapped<void>(), data.data(), data.size());
    device.runOnce([&](vk::CommandBuffer commands) { recordUpload(commands, staging, buffer); });
    return buffer;
}

vk::ImageAspectFlags Image::aspect() const
{
    return info_.format == vk::Format::eD32Sfloat ? vk::ImageAspectFlagBits::eDepth
                                                  : vk::ImageAspectFlagBits::eColor;
}

namespace {

vk::ImageCreateInfo createInfoOf(const ImageInfo& info)
{
    return {.imageType = vk::ImageType::e2D,
            .format = info.format,
            .extent = {info.width, info.height, 1},
            .mipLevels = info.mips,
            .arrayLayers = info.layers,
            .samples = info.samples,
            .tiling = vk::ImageTiling::eOptimal,
            .usage = info.usage};
}

// One line each for what the device does not support.
std::vector<std::string> unmetBy(const Device& device, const ImageInfo& info)
{
    const std::string& name = device.limits().device;
    try {
        const auto properties = device.physical().getImageFormatProperties(
            info.format, vk::ImageType::e2D, vk::ImageTiling::eOptimal, info.usage);
        std::vector<std::string> lines = unmet(name, properties,
                                               {.width = info.width,
                                                .height = info.height,
                                                .layers = info.layers,
                                                .mips = info.mips,
                                                .samples = info.samples,
                                                .remedy = info.remedy});
        if (!lines.empty())
            return lines; // and its size is not to be asked for
    } catch (const vk::FormatNotSupportedError&) {
        return {fmt::format("{} has no {} images for {}", name, vk::to_string(info.format),
                            vk::to_string(info.usage))};
    }
    const vk::ImageCreateInfo create = createInfoOf(info);
    const auto memory = device.handle().getImageMemoryRequirements(vk::DeviceImageMemoryRequirements{
        .pCreateInfo = &create, .planeAspect = vk::ImageAspectFlagBits::eNone});
    return unmet(device.limits(), memory.memoryRequirements.size, 0, info.remedy);
}

} // namespace

void checkImage(const Device& device, const ImageInfo& info)
{
    const std::vector<std::string> problems = unmetBy(device, info);
    if (!problems.empty())
        throw Error("Vulkan: " + problems.front());
}

Image::Image(const Device& device, const ImageInfo& info, const std::string& name) : info_(info)
{
    checkImage(device, info);
    image_ = vk::raii::Image(device.handle(), createInfoOf(info));
    const auto requirements = image_.getMemoryRequirements();
    bytes_ = requirements.size;
    memory_ = device.allocate(requirements, vk::MemoryPropertyFlagBits::eDeviceLocal, info.remedy);
    image_.bindMemory(*memory_.handle, 0);
    device.name(image_, name);

    const auto type =
        info.layers > 1 || info.arrayView ? vk::ImageViewType::e2DArray : vk::ImageViewType::e2D;
    const vk::ImageViewCreateInfo view{.image = *image_,
                                       .viewType = type,
                                       .format = info.format,
                                       .subresourceRange = {aspect(), 0, info.mips, 0, info.layers}};
    view_ = vk::raii::ImageView(device.handle(), view);
}

vk::raii::ImageView Image::layerView(const Device& device, uint32_t layer) const
{
    return {device.handle(), vk::ImageViewCreateInfo{.image = *image_,
                                                     .viewType = vk::ImageViewType::e2D,
                                                     .format = info_.format,
                                                     .subresourceRange = {aspect(), 0, 1, layer, 1}}};
}

namespace {

// Fills an image through a buffer of kStagingBytes or one row, whichever is more: fresh memory costs more
// than a submission.
class HalfImageUpload {
public:
    HalfImageUpload(const Device& device, const Image& image, size_t bytes)
        : device_(device), image_(image), rowBytes_(image.info().width * kTexelBytes),
          staging_(device, std::min(bytes, std::max(kStagingBytes, rowBytes_)), Buffer::MemoryUsage::host,
                   "staging")
    {
    }

    void add(uint32_t mip, std::span<const uint16_t> texels)
    {
        const uint32_t width = std::max(1u, image_.info().width >> mip);
        const uint32_t height = std::max(1u, image_.info().height >> mip);
        const size_t rowBytes = width * kTexelBytes;
        const auto bytes = std::as_bytes(texels);
        for (uint32_t row = 0, count = 0; row < height; row += count) {
            if (used_ + rowBytes > staging_.size())
                flush();
            count = std::min(height - row, uint32_t((staging_.size() - used_) / rowBytes));
            std::memcpy(staging_.mapped<std::byte>() + used_, bytes.data() + row * rowBytes,
                        count * rowBytes);
            copies_.push_back({.bufferOffset = used_,
                               .imageSubresource = {image_.aspect(), mip, 0, 1},
                               .imageOffset = {0, int32_t(row), 0},
                               .imageExtent = {width, count, 1}});
            used_ += count * rowBytes;
        }
    }

    void finish() { flush(true); }

private:
    static constexpr size_t kStagingBytes = 8 << 20, kTexelBytes = 4 * sizeof(uint16_t);

    void flush(bool last = false)
    {
        device_.runOnce([&](vk::CommandBuffer commands) {
            if (!std::exchange(begun_, true))
                imageBarrier(commands, image_.handle(), image_.aspect(), Use::undefined, Use::transferWrite);
            commands.copyBufferToImage(staging_.handle(), image_.handle(),
                                       vk::ImageLayout::eTransferDstOptimal, copies_);
            if (last)
                imageBarrier(commands, image_.handle(), image_.aspect(), Use::transferWrite,
                             Use::shaderSample);
        });
        copies_.clear();
        used_ = 0;
    }

    const Device& device_;
    const Image& image_;
    size_t rowBytes_;
    Buffer staging_;
    size_t used_ = 0;
    bool begun_ = false;
    std::vector<vk::BufferImageCopy> copies_;
};

} // namespace

Image uploadHalfImage(const Device& device, uint32_t width, uint32_t height,
                      const std::vector<std::span<const uint16_t>>& levels, const std::string& name)
{
    Image image(device,
                {.width = width,
                 .height = height,
                 .mips = uint32_t(levels.size()),
                 .usage = vk::ImageUsageFlagBits::eSampled | vk::ImageUsageFlagBits::eTransferDst},
                name);
    size_t bytes = 0;
    for (const auto& level : levels)
        bytes += level.size_bytes();
    HalfImageUpload upload(device, image, bytes);
    for (uint32_t mip = 0; mip < levels.size(); ++mip)
        upload.add(mip, levels[mip]);
    upload.finish();
    return image;
}

std::vector<std::byte> readBack(const Device& device, const Buffer& buffer, size_t bytes)
{
    if (bytes == 0)
        return {};
    const Buffer staging(device, bytes, Buffer::MemoryUsage::host, "read back");
    device.runOnce([&](vk::CommandBuffer commands) {
        commands.copyBuffer(buffer.handle(), staging.handle(), vk::BufferCopy{.size = bytes});
        memoryBarrier(commands, Use::transferWrite, Use::hostRead);
    });
    const auto* data = staging.mapped<std::byte>();
    return {data, data + bytes};
}

std::vector<std::byte> readBack(const Device& device, const Image& image, size_t bytesPerTexel,
                                vk::ImageLayout from)
{
    const size_t bytes = size_t(image.info().width) * image.info().height * bytesPerTexel;
    const Buffer staging(device, bytes, Buffer::MemoryUsage::host, "read back");
    device.runOnce([&](vk::CommandBuffer commands) {
        const vk::BufferImageCopy copy{.imageSubresource = {image.aspect(), 0, 0, 1},
                                       .imageExtent = {image.info().width, image.info().height, 1}};
        commands.copyImageToBuffer(image.handle(), from, staging.handle(), copy);
        memoryBarrier(commands, Use::transferWrite, Use::hostRead);
    });
    const auto* data = staging.mapped<std::byte>();
    return {data, data + bytes};
}

} // namespace lumel::gpu
