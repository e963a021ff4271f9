// Device memory: a few large blocks, of which resources take ranges. Drivers limit the number of allocations,
// some to 4096, and each costs them a call into the kernel.
#pragma once
#include "free_ranges.h"
#include "limits.h"
#include "memory_report.h"
#include <memory>
#include <mutex>

namespace lumel::gpu {

enum class MemoryUsage {
    device,   // the GPU reads and writes it
    host,     // the CPU writes it each frame, the GPU reads it; the CPU never does: it may be uncached
    staging,  // the CPU writes it once, for a copy
    readback, // copies write it, the CPU reads it
};

// Indices of the memory types that serve the usage, best first; typeBits: those that the resource may have.
std::vector<uint32_t> memoryTypesFor(const vk::PhysicalDeviceMemoryProperties& memory, uint32_t typeBits,
                                     MemoryUsage usage);

class Allocator;

// A range of device memory, freed when destroyed.
class Memory {
public:
    Memory() = default;
    vk::DeviceMemory handle() const;
    vk::DeviceSize offset() const { return block_.get_deleter().offset; }
    std::byte* mapped() const; // null where the host does not see it
    bool coherent() const;
    // Before the CPU reads what the GPU has written, where memory is not coherent.
    void invalidate() const;

private:
    friend class Allocator;
    struct Block;
    struct Frees {
        uint64_t offset, size;
        MemoryKind kind;
        void operator()(Block* block) const;
    };
    std::unique_ptr<Block, Frees> block_;
};

struct MemoryRequest {
    vk::MemoryRequirements requirements;
    MemoryUsage usage = MemoryUsage::device;
    MemoryKind kind = MemoryKind::buffers;
    vk::Buffer buffer; // that it is for, or
    vk::Image image;
    bool own = false; // the driver wants an allocation for this one alone
    std::string remedy;
};

// Safe to be called, and memory to be freed, from any thread.
class Allocator {
public:
    Allocator(const vk::raii::Device& device, const vk::PhysicalDeviceMemoryProperties& memory,
              const Limits& limits);
    ~Allocator();
    Allocator(const Allocator&) = delete;
    Allocator& operator=(const Allocator&) = delete;

    // Throws Error with the remedy when out of memory.
    Memory allocate(const MemoryRequest& request);
    MemoryReport report() const;

    // Resources from this size on have allocations of their own, which are returned at once.
    static constexpr uint64_t kOwnBytes = 16 << 20;

private:
    friend class Memory;
    using Blocks = std::vector<std::unique_ptr<Memory::Block>>;
    Memory place(const MemoryRequest& request, uint32_t type);
    Memory takeFrom(Memory::Block& block, const MemoryRequest& request, uint64_t size, uint64_t alignment);
    Memory::Block* addBlock(Blocks& blocks, const MemoryRequest& request, uint32_t type, uint64_t bytes,
                            bool own);
    uint64_t nextBlockBytes(const Blocks& blocks, uint32_t type, uint64_t least) const;
    void free(Memory::Block& block, const Memory::Frees& range);

    const vk::raii::Device& device_;
    const vk::PhysicalDeviceMemoryProperties memory_;
    const Limits limits_;
    mutable std::mutex mutex_;
    // By memory type, and whether they are of images. So that bufferImageGranularity holds, whatever it is,
    // buffers and images share no block.
    std::map<std::pair<uint32_t, bool>, Blocks> blocks_;
    MemoryReport report_;
};

} // namespace lumel::gpu
