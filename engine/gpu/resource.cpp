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
    if (memoryUsage == MemoryUsage::host)
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

Image uploadHalfImage(const Device& device, uint32_t width, uint32_t height,
                      const std::vector<std::vector<uint16_t>>& levels, const std::string& name)
{
    Image image(device,
                {.width = width,
                 .height = height,
                 .mips = uint32_t(levels.size()),
                 .usage = vk::ImageUsageFlagBits::eSampled | vk::ImageUsageFlagBits::eTransferDst},
                name);
    size_t bytes = 0;
    for (const auto& level : levels)
        bytes += level.size() * sizeof(uint16_t);
    const Buffer staging(device, bytes, Buffer::MemoryUsage::host, name + " (staging)");
    std::vector<vk::BufferImageCopy> copies;
    size_t offset = 0;
    for (uint32_t mip = 0; mip < levels.size(); ++mip) {
        std::memcpy(staging.mapped<std::byte>() + offset, levels[mip].data(),
                    levels[mip].size() * sizeof(uint16_t));
        copies.push_back({.bufferOffset = offset,
                          .imageSubresource = {vk::ImageAspectFlagBits::eColor, mip, 0, 1},
                          .imageExtent = {std::max(1u, width >> mip), std::max(1u, height >> mip), 1}});
        offset += levels[mip].size() * sizeof(uint16_t);
    }
    device.runOnce([&](vk::CommandBuffer commands) { recordUpload(commands, staging, image, copies); });
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
