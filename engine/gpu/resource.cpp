#include "resource.h"
#include "barrier.h"
#include "core/error.h"
#include "upload.h"
#include <algorithm>
#include <fmt/format.h>

namespace lumel::gpu {

Buffer::Buffer(const Device& device, size_t bytes, MemoryUsage memoryUsage, const std::string& name,
               const std::string& remedy, MemoryKind kind)
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
    const auto requirements =
        device.handle()
            .getBufferMemoryRequirements2<vk::MemoryRequirements2, vk::MemoryDedicatedRequirements>(
                {.buffer = *buffer_});
    if (memoryUsage == MemoryUsage::staging || memoryUsage == MemoryUsage::readback)
        kind = MemoryKind::staging;
    memory_ = device.memory().allocate(
        {.requirements = requirements.get<vk::MemoryRequirements2>().memoryRequirements,
         .usage = memoryUsage,
         .kind = kind,
         .buffer = *buffer_,
         .image = {},
         .own = bool(requirements.get<vk::MemoryDedicatedRequirements>().requiresDedicatedAllocation),
         .remedy = remedy});
    buffer_.bindMemory(memory_.handle(), memory_.offset());
    address_ = device.handle().getBufferAddress({.buffer = *buffer_});
    if (memoryUsage != MemoryUsage::device || (memory_.coherent() && !device.stages()))
        mapped_ = memory_.mapped();
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

Counters::Counters(const Device& device, std::span<const std::byte> initial, const std::string& name,
                   size_t places)
    : bytes_(initial.size()), initial_(uploadBuffer(device, initial, name + " at first")),
      counters_(device, bytes_, MemoryUsage::device, name)
{
    for (size_t i = 0; i < places; ++i)
        readbacks_.emplace_back(device, bytes_, MemoryUsage::readback, name + " readback");
}

void Counters::recordReset(vk::CommandBuffer commands, List list)
{
    const vk::MemoryBarrier2 before[] = {makeMemoryBarrier(Use::computeReadWrite, Use::transferWrite),
                                         makeMemoryBarrier(Use::transferRead, Use::transferWrite)};
    commands.pipelineBarrier2(vk::DependencyInfo{}.setMemoryBarriers(before));
    for (const Counters* c : list)
        if (c->bytes_ > 0)
            commands.copyBuffer(c->initial_.handle(), c->counters_.handle(),
                                vk::BufferCopy{.size = c->bytes_});
    memoryBarrier(commands, Use::transferWrite, Use::computeReadWrite);
}

void Counters::recordRead(vk::CommandBuffer commands, List list, size_t place)
{
    memoryBarrier(commands, Use::computeWrite, Use::transferRead);
    for (const Counters* c : list)
        if (c->bytes_ > 0)
            commands.copyBuffer(c->counters_.handle(), c->readbacks_[place].handle(),
                                vk::BufferCopy{.size = c->bytes_});
    memoryBarrier(commands, Use::transferWrite, Use::hostRead);
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
    const auto requirements =
        device.handle().getImageMemoryRequirements2<vk::MemoryRequirements2, vk::MemoryDedicatedRequirements>(
            {.image = *image_});
    const auto& dedicated = requirements.get<vk::MemoryDedicatedRequirements>();
    // Drivers prefer it for what they could compress; of small images there may be too many.
    constexpr vk::DeviceSize kSmall = 1 << 20;
    const vk::MemoryRequirements& needed = requirements.get<vk::MemoryRequirements2>().memoryRequirements;
    memory_ = device.memory().allocate({.requirements = needed,
                                        .usage = MemoryUsage::device,
                                        .kind = info.kind,
                                        .buffer = {},
                                        .image = *image_,
                                        .own = dedicated.requiresDedicatedAllocation ||
                                               (dedicated.prefersDedicatedAllocation && needed.size > kSmall),
                                        .remedy = info.remedy});
    image_.bindMemory(memory_.handle(), memory_.offset());
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

std::vector<std::byte> readBack(const Device& device, const Buffer& buffer, size_t bytes)
{
    if (bytes == 0)
        return {};
    const Buffer staging(device, bytes, MemoryUsage::readback, "read back");
    device.runOnce([&](vk::CommandBuffer commands) {
        commands.copyBuffer(buffer.handle(), staging.handle(), vk::BufferCopy{.size = bytes});
        memoryBarrier(commands, Use::transferWrite, Use::hostRead);
    });
    const auto* data = staging.read<std::byte>();
    return {data, data + bytes};
}

std::vector<std::byte> readBack(const Device& device, const Image& image, size_t bytesPerTexel,
                                vk::ImageLayout from)
{
    const size_t bytes = size_t(image.info().width) * image.info().height * bytesPerTexel;
    const Buffer staging(device, bytes, MemoryUsage::readback, "read back");
    device.runOnce([&](vk::CommandBuffer commands) {
        const vk::BufferImageCopy copy{.imageSubresource = {image.aspect(), 0, 0, 1},
                                       .imageExtent = {image.info().width, image.info().height, 1}};
        commands.copyImageToBuffer(image.handle(), from, staging.handle(), copy);
        memoryBarrier(commands, Use::transferWrite, Use::hostRead);
    });
    const auto* data = staging.read<std::byte>();
    return {data, data + bytes};
}

} // namespace lumel::gpu
