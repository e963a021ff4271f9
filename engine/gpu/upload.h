// Uploads: what the CPU has, in device memory.
#pragma once
#include "barrier.h"
#include "resource.h"

namespace lumel::gpu {

// Gathers uploads into few submissions. Buffers and images are filled once finish() returns, and must live
// until the batch is destroyed. Each thread has batches of its own.
class UploadBatch {
public:
    explicit UploadBatch(const Device& device) : device_(device) {}
    ~UploadBatch();
    UploadBatch(const UploadBatch&) = delete;
    UploadBatch& operator=(const UploadBatch&) = delete;

    Buffer buffer(std::span<const std::byte> data, const std::string& name,
                  MemoryKind kind = MemoryKind::buffers);
    template<class T>
    Buffer buffer(const std::vector<T>& data, const std::string& name, MemoryKind kind = MemoryKind::buffers)
    {
        return buffer(std::as_bytes(std::span(data)), name, kind);
    }
    // An RGBA16F image with all its mips for sampling. levels[i] holds width >> i by height >> i RGBA half
    // texels (floor, at least 1).
    Image halfImage(uint32_t width, uint32_t height, const std::vector<std::span<const uint16_t>>& levels,
                    const std::string& name);
    // In an image of halfImage(), the levels from `first` on, in place of what they were. Frames in flight
    // still see that; those submitted once finish() has returned see what is new, and none may be between.
    void refill(const Image& image, uint32_t first, const std::vector<std::span<const uint16_t>>& levels);
    // Submits what is left and waits for all.
    void finish();

private:
    struct BufferCopy {
        vk::Buffer to;
        vk::BufferCopy range;
    };
    struct ImageCopy {
        vk::Image to;
        vk::BufferImageCopy range;
    };
    // One submission. The CPU fills one part while the GPU copies from the other.
    struct Part {
        Buffer staging;
        vk::raii::CommandBuffer commands = nullptr;
        vk::raii::Fence fence = nullptr;
        size_t used = 0;
        bool submitted = false;
        std::vector<vk::ImageMemoryBarrier2> before, after;
        std::vector<BufferCopy> buffers;
        std::vector<ImageCopy> images;
    };
    struct Room {
        std::span<std::byte> bytes;
        size_t offset; // in the part's staging buffer
    };
    Room reserve(size_t least, size_t most); // between so many bytes
    void fill(const Image& image, uint32_t first, const std::vector<std::span<const uint16_t>>& levels,
              Use before);
    void copyMip(const Image& image, uint32_t mip, std::span<const std::byte> texels);
    Part& part() { return parts_[current_]; }
    void open(Part& part, size_t least);
    void record(const Part& part) const;
    void submit();
    void wait(Part& part);

    const Device& device_;
    vk::raii::CommandPool pool_ = nullptr; // when first needed
    std::array<Part, 2> parts_;
    size_t current_ = 0;
};

// One by one, each in a submission of its own where it needs any.
Buffer uploadBuffer(const Device& device, std::span<const std::byte> data, const std::string& name);
template<class T>
Buffer uploadBuffer(const Device& device, const std::vector<T>& data, const std::string& name)
{
    return uploadBuffer(device, std::as_bytes(std::span(data)), name);
}

} // namespace lumel::gpu
