// Arrays of many MiB: their memory comes in large pages where the system has them, since a fault for each
// 4 KiB takes longer than most work on them; and their elements are not set to zero.
#pragma once
#include <cstddef>
#include <cstdlib>
#include <new>
#include <utility>
#include <vector>
#ifdef __linux__
#include <sys/mman.h>
#endif

namespace lumel {

template<class T>
struct LargePages {
    using value_type = T;
    static constexpr std::size_t kPage = std::size_t(2) << 20;

    LargePages() = default;
    template<class U>
    LargePages(const LargePages<U>&) // NOLINT: allocators convert
    {
    }

    T* allocate(std::size_t count)
    {
        const std::size_t bytes = count * sizeof(T);
        const std::size_t alignment = bytes < kPage ? alignof(std::max_align_t) : kPage;
        void* const memory = std::aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment);
        if (!memory)
            throw std::bad_alloc();
#ifdef MADV_HUGEPAGE
        if (bytes >= kPage)
            madvise(memory, bytes, MADV_HUGEPAGE);
#endif
        return static_cast<T*>(memory);
    }
    void deallocate(T* memory, std::size_t)
    {
        std::free(memory);
    }

    // Of an element without a value: none.
    template<class U>
    void construct(U* at)
    {
        ::new (static_cast<void*>(at)) U;
    }
    template<class U, class... Arguments>
    void construct(U* at, Arguments&&... arguments)
    {
        ::new (static_cast<void*>(at)) U(std::forward<Arguments>(arguments)...);
    }
    bool operator==(const LargePages&) const = default;
};

template<class T>
using LargeArray = std::vector<T, LargePages<T>>;

} // namespace lumel
