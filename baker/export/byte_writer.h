// Little-endian numbers, one after the other.
#pragma once
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

namespace lumel::baker {

class ByteWriter {
public:
    void word(uint32_t value) { number(value); }
    void longWord(uint64_t value) { number(value); }
    void text(const std::string& characters) { add(std::as_bytes(std::span(characters))); }
    void add(std::span<const std::byte> bytes) { bytes_.insert(bytes_.end(), bytes.begin(), bytes.end()); }
    void padTo(size_t multiple, std::byte filler = std::byte(0))
    {
        bytes_.resize((bytes_.size() + multiple - 1) / multiple * multiple, filler);
    }
    // Changes a number that is already there.
    void setLongWord(size_t at, uint64_t value) { std::memcpy(bytes_.data() + at, &value, sizeof value); }
    size_t size() const { return bytes_.size(); }
    std::vector<std::byte> take() { return std::move(bytes_); }

private:
    template<class T>
    void number(T value)
    {
        static_assert(std::endian::native == std::endian::little);
        add(std::as_bytes(std::span(&value, 1)));
    }
    std::vector<std::byte> bytes_;
};

} // namespace lumel::baker
