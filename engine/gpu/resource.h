// Buffers and images with their memory.
#pragma once
#include "device.h"
#include "host_work.h"
#include <cstring>
#include <span>

namespace lumel::gpu {

// A storage buffer with a device address. Buffers stay mapped where the host sees their memory.
class Buffer {
public:
    using MemoryUsage = gpu::MemoryUsage;
    Buffer() = default;
    // remedy: what to do when the device cannot allocate it.
    Buffer(const Device& device, size_t bytes, MemoryUsage memoryUsage, const std::string& name,
           const std::string& remedy = "use a smaller scene", MemoryKind kind = MemoryKind::buffers);

    vk::Buffer handle() const { return *buffer_; }
    vk::DeviceAddress address() const { return address_; }
    size_t size() const { return size_; }
    explicit operator bool() const { return size_ > 0; }
    // To write to. Of MemoryUsage::device null where it takes a copy: UploadBatch does either.
    template<class T>
    T* mapped() const
    {
        return reinterpret_cast<T*>(mapped_);
    }
    // Where mapped() is not null.
    template<class T>
    void write(std::span<const T> values, size_t first = 0) const
    {
        if (!values.empty())
            std::memcpy(mapped<T>() + first, values.data(), values.size_bytes());
        hostWork().uploadedBytes += values.size_bytes();
    }
    // Of MemoryUsage::readback, once the commands that copied to it have finished.
    template<class T>
    const T* read() const
    {
        memory_.invalidate();
        return reinterpret_cast<const T*>(mapped_);
    }

private:
    Memory memory_;
    vk::raii::Buffer buffer_ = nullptr;
    vk::DeviceAddress address_ = 0;
    size_t size_ = 0;
    std::byte* mapped_ = nullptr;
};

// What shaders count and the CPU reads: counters in device memory, and where they are copied to, a place for
// each frame in flight.
class Counters {
public:
    // initial: what they start from.
    Counters(const Device& device, std::span<const std::byte> initial, const std::string& name,
             size_t places = 1);
    template<class T>
    Counters(const Device& device, const std::vector<T>& initial, const std::string& name, size_t places = 1)
        : Counters(device, std::as_bytes(std::span(initial)), name, places)
    {
    }

    using List = std::initializer_list<const Counters*>;
    static void recordReset(vk::CommandBuffer commands, List list); // then compute shaders may count
    // What compute shaders have counted.
    static void recordRead(vk::CommandBuffer commands, List list, size_t place = 0);
    vk::DeviceAddress address() const { return counters_.address(); }
    // After the recorded commands have finished.
    template<class T>
    const T* read(size_t place = 0) const
    {
        return readbacks_[place].read<T>();
    }

private:
    size_t bytes_;
    Buffer initial_, counters_;
    std::vector<Buffer> readbacks_;
};

// All of a buffer as texels of four words. Throws Error when they are more than the device takes.
vk::raii::BufferView makeTexelView(const Device& device, const Buffer& buffer);

struct ImageInfo {
    vk::Format format = vk::Format::eR16G16B16A16Sfloat;
    uint32_t width = 1, height = 1;
    uint32_t mips = 1, layers = 1;
    vk::ImageUsageFlags usage;
    vk::SampleCountFlagBits samples = vk::SampleCountFlagBits::e1;
    bool arrayView = false;                  // sampler2DArray / image2DArray even with one layer
    const char* remedy = "use smaller maps"; // when the device does not support or cannot allocate it
    MemoryKind kind = MemoryKind::targets;
    bool operator==(const ImageInfo&) const = default;
};

// Throws Error with the remedy when the device has no such images.
void checkImage(const Device& device, const ImageInfo& info);

class Image {
public:
    Image() = default;
    Image(const Device& device, const ImageInfo& info, const std::string& name);

    vk::Image handle() const { return *image_; }
    vk::ImageView view() const { return *view_; }
    vk::raii::ImageView layerView(const Device& device, uint32_t layer) const; // to render to
    const ImageInfo& info() const { return info_; }
    vk::Extent2D extent() const { return {info_.width, info_.height}; }
    vk::ImageAspectFlags aspect() const;
    explicit operator bool() const { return *image_; }

private:
    ImageInfo info_;
    Memory memory_;
    vk::raii::Image image_ = nullptr;
    vk::raii::ImageView view_ = nullptr;
};

// Copies into a buffer or the mips of an image; whatever follows, in any shader or command, may read them.
void recordUpload(vk::CommandBuffer commands, const Buffer& staging, const Buffer& to);
void recordUpload(vk::CommandBuffer commands, const Buffer& staging, const Image& to,
                  const std::vector<vk::BufferImageCopy>& mips);

// Reads a buffer's first bytes back.
std::vector<std::byte> readBack(const Device& device, const Buffer& buffer, size_t bytes);

// Reads mip 0, layer 0 of an image in use `from` back into tightly packed texels and leaves it in that use.
std::vector<std::byte> readBack(const Device& device, const Image& image, size_t bytesPerTexel,
                                vk::ImageLayout from);

} // namespace lumel::gpu
