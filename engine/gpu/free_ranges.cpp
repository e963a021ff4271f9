#include "free_ranges.h"
#include <iterator>

namespace lumel::gpu {
namespace {

uint64_t aligned(uint64_t offset, uint64_t alignment)
{
    return (offset + alignment - 1) & ~(alignment - 1);
}

} // namespace

std::optional<uint64_t> FreeRanges::take(uint64_t size, uint64_t alignment)
{
    if (size > freeBytes_)
        return {};
    auto best = free_.end();
    for (auto i = free_.begin(); i != free_.end(); ++i) {
        const uint64_t end = aligned(i->first, alignment) + size;
        if (end <= i->first + i->second && (best == free_.end() || i->second < best->second))
            best = i;
    }
    if (best == free_.end())
        return {};
    const auto [first, room] = *best;
    free_.erase(best);
    const uint64_t offset = aligned(first, alignment);
    add(first, offset - first);
    add(offset + size, first + room - offset - size);
    freeBytes_ -= size;
    return offset;
}

void FreeRanges::give(uint64_t offset, uint64_t size)
{
    freeBytes_ += size;
    const auto after = free_.lower_bound(offset);
    if (after != free_.end() && after->first == offset + size) {
        size += after->second;
        free_.erase(after);
    }
    const auto next = free_.lower_bound(offset);
    if (next != free_.begin())
        if (const auto before = std::prev(next); before->first + before->second == offset) {
            before->second += size;
            return;
        }
    add(offset, size);
}

void FreeRanges::add(uint64_t offset, uint64_t size)
{
    if (size > 0)
        free_[offset] = size;
}

} // namespace lumel::gpu
