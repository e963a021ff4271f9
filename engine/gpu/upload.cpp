#include "upload.h"
#include "core/error.h"
#include <algorithm>

namespace lumel::gpu {
namespace {

// Fresh memory costs more than a submission.
constexpr size_t kPartBytes = 8 << 20;
constexpr size_t kTexelBytes = 4 * sizeof(uint16_t);
constexpr size_t kAlignment = 16; // of copies: of a texel, and of four bytes

} // namespace

UploadBatch::~UploadBatch()
{
    for (Part& part : parts_)
        try {
            wait(part);
        } catch (const std::exception&) { // the device is lost; its next user says so
        }
}

Buffer UploadBatch::buffer(std::span<const std::byte> data, const std::string& name, MemoryKind kind)
{
    Buffer result(device_, data.size(), MemoryUsage::device, name, "use a smaller scene", kind);
    if (result.mapped<std::byte>()) { // submitting makes it visible
        result.write(data);
        return result;
    }
    for (size_t done = 0; done < data.size();) {
        const Room room = reserve(1, data.size() - done);
        std::memcpy(room.bytes.data(), data.data() + done, room.bytes.size());
        part().buffers.push_back(
            {result.handle(), {.srcOffset = room.offset, .dstOffset = done, .size = room.bytes.size()}});
        done += room.bytes.size();
    }
    return result;
}

Image UploadBatch::halfImage(uint32_t width, uint32_t height,
                             const std::vector<std::span<const uint16_t>>& levels, const std::string& name)
{
    Image image(device_,
                {.width = width,
                 .height = height,
                 .mips = uint32_t(levels.size()),
                 .usage = vk::ImageUsageFlagBits::eSampled | vk::ImageUsageFlagBits::eTransferDst,
                 .kind = MemoryKind::materials},
                name);
    fill(image, 0, levels, Use::undefined);
    return image;
}

void UploadBatch::refill(const Image& image, uint32_t first,
                         const std::vector<std::span<const uint16_t>>& levels)
{
    fill(image, first, levels, Use::shaderSample);
}

void UploadBatch::fill(const Image& image, uint32_t first,
                       const std::vector<std::span<const uint16_t>>& levels, Use before)
{
    reserve(kTexelBytes * image.info().width, 0); // so that the barrier goes before the first copy
    part().before.push_back(makeImageBarrier(image.handle(), image.aspect(), before, Use::transferWrite));
    for (uint32_t mip = first; mip < levels.size(); ++mip)
        copyMip(image, mip, std::as_bytes(levels[mip]));
    part().after.push_back(
        makeImageBarrier(image.handle(), image.aspect(), Use::transferWrite, Use::shaderSample));
}

void UploadBatch::copyMip(const Image& image, uint32_t mip, std::span<const std::byte> texels)
{
    const uint32_t width = std::max(1u, image.info().width >> mip);
    const uint32_t height = std::max(1u, image.info().height >> mip);
    const size_t rowBytes = width * kTexelBytes;
    for (uint32_t row = 0, count = 0; row < height; row += count) {
        const Room room = reserve(rowBytes, (height - row) * rowBytes);
        count = uint32_t(room.bytes.size() / rowBytes);
        std::memcpy(room.bytes.data(), texels.data() + row * rowBytes, count * rowBytes);
        part().images.push_back({image.handle(),
                                 {.bufferOffset = room.offset,
                                  .imageSubresource = {image.aspect(), mip, 0, 1},
                                  .imageOffset = {0, int32_t(row), 0},
                                  .imageExtent = {width, count, 1}}});
    }
}

UploadBatch::Room UploadBatch::reserve(size_t least, size_t most)
{
    if (part().staging && part().used + least > part().staging.size())
        submit();
    if (part().staging.size() < least)
        open(part(), least);
    const size_t offset = part().used, size = std::min(most, part().staging.size() - offset);
    hostWork().uploadedBytes += size;
    part().used = std::min((offset + size + kAlignment - 1) / kAlignment * kAlignment, part().staging.size());
    return {{part().staging.mapped<std::byte>() + offset, size}, offset};
}

void UploadBatch::open(Part& part, size_t least)
{
    if (!*pool_)
        pool_ = vk::raii::CommandPool(device_.handle(),
                                      {.flags = vk::CommandPoolCreateFlagBits::eResetCommandBuffer |
                                                vk::CommandPoolCreateFlagBits::eTransient,
                                       .queueFamilyIndex = device_.queueFamily()});
    try {
        part.staging = Buffer(device_, std::max(kPartBytes, least), MemoryUsage::staging, "staging");
    } catch (const Error&) { // whoever gives up destroys what the other part is copied to
        wait(parts_[1 - current_]);
        throw;
    }
    if (*part.fence)
        return;
    vk::raii::CommandBuffers buffers(device_.handle(), {.commandPool = *pool_, .commandBufferCount = 1});
    part.commands = std::move(buffers.front());
    part.fence = vk::raii::Fence(device_.handle(), vk::FenceCreateInfo{});
}

void UploadBatch::record(const Part& part) const
{
    const vk::CommandBuffer commands = *part.commands;
    commands.begin(vk::CommandBufferBeginInfo{.flags = vk::CommandBufferUsageFlagBits::eOneTimeSubmit});
    commands.pipelineBarrier2(vk::DependencyInfo{}.setImageMemoryBarriers(part.before));
    for (const BufferCopy& copy : part.buffers)
        commands.copyBuffer(part.staging.handle(), copy.to, copy.range);
    for (const ImageCopy& copy : part.images)
        commands.copyBufferToImage(part.staging.handle(), copy.to, vk::ImageLayout::eTransferDstOptimal,
                                   copy.range);
    const vk::MemoryBarrier2 buffers = makeMemoryBarrier(Use::transferWrite, Use::general);
    commands.pipelineBarrier2(
        vk::DependencyInfo{}.setMemoryBarriers(buffers).setImageMemoryBarriers(part.after));
    commands.end();
}

// Goes on with the other part, once that is copied.
void UploadBatch::submit()
{
    record(part());
    device_.submit(*part().commands, *part().fence);
    part().submitted = true;
    current_ = 1 - current_;
    wait(part());
}

void UploadBatch::wait(Part& part)
{
    if (!std::exchange(part.submitted, false))
        return;
    device_.wait(*part.fence);
    part.used = 0;
    part.before.clear();
    part.after.clear();
    part.buffers.clear();
    part.images.clear();
}

void UploadBatch::finish()
{
    if (!part().buffers.empty() || !part().images.empty())
        submit();
    for (Part& part : parts_)
        wait(part);
}

Buffer uploadBuffer(const Device& device, std::span<const std::byte> data, const std::string& name)
{
    UploadBatch batch(device);
    Buffer buffer = batch.buffer(data, name);
    batch.finish();
    return buffer;
}

} // namespace lumel::gpu
