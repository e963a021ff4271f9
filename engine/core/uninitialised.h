// Arrays of many MiB whose elements are not set to zero: that would touch all of their memory on one thread
// before others fill it.
#pragma once
#include <memory>
#include <utility>
#include <vector>

namespace lumel {

template<class T>
struct UninitialisedAllocator : std::allocator<T> {
    template<class U>
    struct rebind {
        using other = UninitialisedAllocator<U>;
    };
    // Of an element without a value: none.
    template<class U>
    void construct(U* at)
    {
        ::new (static_cast<void*>(at)) U;
    }
    template<class U, class... Arguments>
    void construct(U* at, Arguments&&... arguments)
    {
        std::construct_at(at, std::forward<Arguments>(arguments)...);
    }
};

template<class T>
using UninitialisedArray = std::vector<T, UninitialisedAllocator<T>>;

} // namespace lumel
