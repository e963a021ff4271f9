// RAII for file descriptors and memory mappings; the number of threads.
#pragma once
#include <cstddef>
#include <span>
#include <utility>

namespace lumel {

class Descriptor {
public:
    explicit Descriptor(int number = -1) : number_(number) {}
    Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
    Descriptor& operator=(Descriptor other) noexcept
    {
        std::swap(number_, other.number_);
        return *this;
    }
    ~Descriptor();
    int get() const { return number_; }
    void reset() { *this = Descriptor(); }

private:
    int number_;
};

// The first `size` bytes of a file, shared with whoever else maps it. Throws std::bad_alloc.
class Mapping {
public:
    enum Access { read, write };
    Mapping() = default;
    Mapping(const Descriptor& file, size_t size, Access access);
    Mapping(Mapping&& other) noexcept : bytes_(std::exchange(other.bytes_, {})) {}
    Mapping& operator=(Mapping other) noexcept
    {
        std::swap(bytes_, other.bytes_);
        return *this;
    }
    ~Mapping();
    std::span<std::byte> bytes() const { return bytes_; }

private:
    std::span<std::byte> bytes_;
};

// Of this process.
size_t threadCount();

} // namespace lumel
