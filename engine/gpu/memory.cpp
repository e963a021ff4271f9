#include "memory.h"
#include "core/error.h"
#include <algorithm>
#include <fmt/format.h>
#include <optional>

namespace lumel::gpu {
namespace {

using Property = vk::MemoryPropertyFlagBits;

// Blocks double from the first one's size on, up to this and to a share of their heap.
constexpr uint64_t kFirstBlockBytes = 4 << 20, kMostBlockBytes = 128 << 20, kHeapShare = 32;
// A cache line: what the CPU writes beside is no business of the GPU's.
constexpr uint64_t kLeastAlignment = 64;

// What a usage must have, and what it would rather have or not: the earlier flag matters more.
struct Preferences {
    vk::MemoryPropertyFlags required;
    struct Wish {
        Property flag;
        bool wanted;
    };
    std::vector<Wish> wishes;
};

Preferences preferencesOf(MemoryUsage usage)
{
    constexpr auto coherent = Property::eHostVisible | Property::eHostCoherent;
    switch (usage) {
    case MemoryUsage::device:
        return {Property::eDeviceLocal, {{Property::eHostVisible, false}}};
    case MemoryUsage::host:
        return {coherent, {{Property::eDeviceLocal, true}, {Property::eHostCached, false}}};
    case MemoryUsage::staging:
        return {coherent, {{Property::eDeviceLocal, false}, {Property::eHostCached, false}}};
    case MemoryUsage::readback:
        return {Property::eHostVisible,
                {{Property::eHostCached, true},
                 {Property::eHostCoherent, true},
                 {Property::eDeviceLocal, false}}};
    }
    return {};
}

uint64_t roundedUp(uint64_t size, uint64_t step)
{
    return (size + step - 1) / step * step;
}

} // namespace

std::vector<uint32_t> memoryTypesFor(const vk::PhysicalDeviceMemoryProperties& memory, uint32_t typeBits,
                                     MemoryUsage usage)
{
    // Others need features that are not enabled: protected, lazily allocated, vendors' own.
    constexpr auto known =
        Property::eDeviceLocal | Property::eHostVisible | Property::eHostCoherent | Property::eHostCached;
    const Preferences preferences = preferencesOf(usage);
    std::vector<std::pair<uint32_t, uint32_t>> types; // unmet wishes, index
    for (uint32_t i = 0; i < memory.memoryTypeCount; ++i) {
        const vk::MemoryPropertyFlags flags = memory.memoryTypes[i].propertyFlags;
        if (!(typeBits & (1u << i)) || (flags & preferences.required) != preferences.required ||
            (flags & ~known))
            continue;
        uint32_t unmet = 0;
        for (const auto& wish : preferences.wishes)
            unmet = 2 * unmet + (bool(flags & wish.flag) != wish.wanted ? 1 : 0);
        types.emplace_back(unmet, i);
    }
    std::ranges::sort(types);
    std::vector<uint32_t> indices;
    for (const auto& type : types)
        indices.push_back(type.second);
    return indices;
}

struct Memory::Block {
    Allocator& owner;
    vk::raii::DeviceMemory memory;
    FreeRanges ranges;
    std::pair<uint32_t, bool> key; // of the blocks that it is one of
    bool own;                      // of one resource
    bool coherent;                 // host-coherent
    std::byte* mapped;
};

void Memory::Frees::operator()(Block* block) const
{
    block->owner.free(*block, *this);
}

vk::DeviceMemory Memory::handle() const
{
    return *block_->memory;
}

std::byte* Memory::mapped() const
{
    return block_ && block_->mapped ? block_->mapped + offset() : nullptr;
}

bool Memory::coherent() const
{
    return block_->coherent;
}

void Memory::invalidate() const
{
    if (!block_->coherent) // ranges of such memory begin and end at multiples of the atom
        block_->owner.device_.invalidateMappedMemoryRanges(
            vk::MappedMemoryRange{.memory = handle(), .offset = offset(), .size = block_.get_deleter().size});
}

Allocator::Allocator(const vk::raii::Device& device, const vk::PhysicalDeviceMemoryProperties& memory,
                     const Limits& limits)
    : device_(device), memory_(memory), limits_(limits)
{
}

Allocator::~Allocator() = default;

MemoryReport Allocator::report() const
{
    const std::lock_guard lock(mutex_);
    return report_;
}

Memory Allocator::allocate(const MemoryRequest& request)
{
    const std::lock_guard lock(mutex_);
    for (const uint32_t type : memoryTypesFor(memory_, request.requirements.memoryTypeBits, request.usage))
        if (Memory memory = place(request, type); memory.block_)
            return memory;
    throw Error(fmt::format("Vulkan: {} MiB: out of device memory; {}", request.requirements.size >> 20,
                            request.remedy));
}

// Without a block where there is no room.
Memory Allocator::place(const MemoryRequest& request, uint32_t type)
{
    const vk::MemoryPropertyFlags flags = memory_.memoryTypes[type].propertyFlags;
    const bool byAtoms = (flags & Property::eHostVisible) && !(flags & Property::eHostCoherent);
    const uint64_t step = byAtoms ? limits_.core.nonCoherentAtomSize : 1;
    const uint64_t size = roundedUp(request.requirements.size, step);
    const uint64_t alignment = std::max({request.requirements.alignment, step, kLeastAlignment});
    Blocks& blocks = blocks_[{type, bool(request.image)}];
    if (!request.own && size < kOwnBytes) {
        for (const auto& block : blocks)
            if (Memory memory = takeFrom(*block, request, size, alignment); memory.block_)
                return memory;
        if (Memory::Block* block = addBlock(blocks, request, type, nextBlockBytes(blocks, type, size), false))
            return takeFrom(*block, request, size, alignment);
    }
    Memory::Block* own = addBlock(blocks, request, type, size, true);
    return own ? takeFrom(*own, request, size, 1) : Memory();
}

Memory Allocator::takeFrom(Memory::Block& block, const MemoryRequest& request, uint64_t size,
                           uint64_t alignment)
{
    Memory memory;
    const std::optional<uint64_t> offset = block.ranges.take(size, alignment);
    if (!offset)
        return memory;
    memory.block_ = {&block, Memory::Frees{*offset, size, request.kind}};
    report_.bytes[size_t(request.kind)] += size;
    return memory;
}

uint64_t Allocator::nextBlockBytes(const Blocks& blocks, uint32_t type, uint64_t least) const
{
    const uint64_t heap = memory_.memoryHeaps[memory_.memoryTypes[type].heapIndex].size;
    uint64_t bytes = 0;
    for (const auto& block : blocks)
        bytes += block->own ? 0 : block->ranges.size();
    const uint64_t most = std::clamp(heap / kHeapShare, kFirstBlockBytes, kMostBlockBytes);
    bytes = std::clamp(bytes, kFirstBlockBytes, most);
    return std::max(bytes, roundedUp(least, kFirstBlockBytes));
}

// Null when the heap is exhausted. Throws Error beyond the device's limits.
Memory::Block* Allocator::addBlock(Blocks& blocks, const MemoryRequest& request, uint32_t type,
                                   uint64_t bytes, bool own)
{
    const auto problems = unmet(limits_, bytes, report_.allocations + 1, request.remedy);
    if (!problems.empty())
        throw Error("Vulkan: " + problems.front());
    const bool images = bool(request.image);
    const vk::MemoryDedicatedAllocateInfo dedicated{.image = request.image, .buffer = request.buffer};
    const vk::MemoryAllocateFlagsInfo flags{.pNext = own ? &dedicated : nullptr,
                                            .flags = images ? vk::MemoryAllocateFlags()
                                                            : vk::MemoryAllocateFlagBits::eDeviceAddress};
    const vk::MemoryPropertyFlags properties = memory_.memoryTypes[type].propertyFlags;
    try {
        vk::raii::DeviceMemory memory(device_,
                                      {.pNext = &flags, .allocationSize = bytes, .memoryTypeIndex = type});
        void* mapped = nullptr;
        if ((properties & Property::eHostVisible) && !images)
            mapped = memory.mapMemory(0, VK_WHOLE_SIZE);
        blocks.push_back(
            std::unique_ptr<Memory::Block>(new Memory::Block{*this,
                                                             std::move(memory),
                                                             FreeRanges(bytes),
                                                             {type, images},
                                                             own,
                                                             bool(properties & Property::eHostCoherent),
                                                             static_cast<std::byte*>(mapped)}));
    } catch (const vk::OutOfDeviceMemoryError&) {
        return nullptr;
    } catch (const vk::OutOfHostMemoryError&) { // software devices
        return nullptr;
    } catch (const vk::MemoryMapFailedError&) { // no room among the addresses
        return nullptr;
    }
    ++report_.allocations;
    report_.allocatedBytes += bytes;
    return blocks.back().get();
}

// Empty blocks are returned to the driver, apart from the first of a type, which is small.
void Allocator::free(Memory::Block& block, const Memory::Frees& range)
{
    const std::lock_guard lock(mutex_);
    block.ranges.give(range.offset, range.size);
    report_.bytes[size_t(range.kind)] -= range.size;
    Blocks& blocks = blocks_[block.key];
    const bool kept = !block.own && &block == blocks.front().get() && block.ranges.size() <= kFirstBlockBytes;
    if (!block.ranges.allFree() || kept)
        return;
    --report_.allocations;
    report_.allocatedBytes -= block.ranges.size();
    std::erase_if(blocks, [&](const auto& b) { return b.get() == &block; });
}

} // namespace lumel::gpu
