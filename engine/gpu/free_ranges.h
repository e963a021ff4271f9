// The free ranges of one block of memory. Knows no Vulkan.
#pragma once
#include <cstdint>
#include <map>
#include <optional>

namespace lumel::gpu {

class FreeRanges {
public:
    explicit FreeRanges(uint64_t size) : size_(size), freeBytes_(size), free_{{0, size}} {}

    // The offset of a range in the smallest free one that holds it, nothing where none does. alignment: a
    // power of two.
    std::optional<uint64_t> take(uint64_t size, uint64_t alignment);
    // What take() returned. Neighbours that are free become one range.
    void give(uint64_t offset, uint64_t size);

    uint64_t size() const { return size_; }
    bool allFree() const { return freeBytes_ == size_; }
    size_t count() const { return free_.size(); }

private:
    void add(uint64_t offset, uint64_t size);

    uint64_t size_, freeBytes_;
    std::map<uint64_t, uint64_t> free_; // size by offset
};

} // namespace lumel::gpu
