#include "ktx2_reader.h"
#include <algorithm>
#include <cstring>
#include <fmt/format.h>
#include <zstd.h>

namespace lumel::baker::test {
namespace {

// Bytes of a texel or block, its side, the size of a number, the colour model, and each sample's bits.
struct Expected {
    uint32_t blockBytes, blockSide, typeSize, model;
    std::vector<uint32_t> bits;
};

bool expectedOf(uint32_t format, Expected& e)
{
    switch (format) {
    case 9:
        e = {1, 1, 1, 1, {8}};
        return true;
    case 37:
    case 43:
        e = {4, 1, 1, 1, {8, 8, 8, 8}};
        return true;
    case 97:
        e = {8, 1, 2, 1, {16, 16, 16, 16}};
        return true;
    case 139:
        e = {8, 4, 1, 131, {64}};
        return true;
    case 141:
        e = {16, 4, 1, 132, {64, 64}};
        return true;
    default:
        return false;
    }
}

class Reader {
public:
    Reader(const std::vector<std::byte>& bytes, Ktx2& out) : bytes_(bytes), out_(out) {}

    std::string read()
    {
        for (const auto step : {&Reader::header, &Reader::descriptor, &Reader::keyValues, &Reader::levels})
            if (const std::string wrong = (this->*step)(); !wrong.empty())
                return wrong;
        return "";
    }

private:
    uint32_t word(size_t at) const
    {
        uint32_t value = 0;
        if (at + 4 <= bytes_.size())
            std::memcpy(&value, &bytes_[at], 4);
        return value;
    }
    uint64_t longWord(size_t at) const { return word(at) | uint64_t(word(at + 4)) << 32; }

    std::string header()
    {
        const unsigned char id[] = {0xab, 'K', 'T', 'X', ' ', '2', '0', 0xbb, '\r', '\n', 0x1a, '\n'};
        if (bytes_.size() < 80 || std::memcmp(bytes_.data(), id, sizeof id) != 0)
            return "identifier";
        out_.format = word(12);
        if (!expectedOf(out_.format, expected_))
            return "format";
        if (word(16) != expected_.typeSize)
            return "typeSize";
        out_.width = word(20);
        out_.height = word(24);
        if (word(28) != 0 || word(32) != 0 || word(36) != 1)
            return "not one two-dimensional image";
        levelCount_ = word(40);
        uint32_t most = 1;
        while (std::max(out_.width, out_.height) >> most)
            ++most;
        if (levelCount_ != most)
            return "not all levels";
        out_.scheme = word(44);
        if (out_.scheme != 0 && out_.scheme != 2)
            return "supercompression scheme";
        if (word(48) != 80 + 24 * levelCount_)
            return "the descriptor does not follow the level index";
        if (word(56) != word(48) + word(52) || word(48) % 4 != 0)
            return "key values do not follow the descriptor";
        return longWord(64) == 0 && longWord(72) == 0 ? "" : "global data without a use";
    }

    std::string descriptor()
    {
        const size_t at = word(48);
        const uint32_t count = uint32_t(expected_.bits.size()), size = 24 + 16 * count;
        if (word(52) != size + 4 || word(at) != size + 4)
            return "size of the descriptor";
        if (word(at + 4) != 0 || word(at + 8) != (2 | size << 16))
            return "vendor, type or version of the descriptor";
        out_.model = word(at + 12) & 0xff;
        out_.transfer = word(at + 12) >> 16 & 0xff;
        if (out_.model != expected_.model || (word(at + 12) >> 8 & 0xff) != 1 || word(at + 12) >> 24 != 0)
            return "colour model, primaries or flags";
        if (out_.transfer != (out_.format == 43 ? 2u : 1u))
            return "transfer function";
        const uint32_t last = expected_.blockSide - 1;
        if (word(at + 16) != (last | last << 8))
            return "dimensions of the block";
        if (word(at + 20) != expected_.blockBytes || word(at + 24) != 0)
            return "bytes of the plane";
        uint32_t offset = 0;
        for (uint32_t i = 0; i < count; ++i) {
            const size_t sample = at + 28 + 16 * i;
            if ((word(sample) & 0xffff) != offset || (word(sample) >> 16 & 0xff) != expected_.bits[i] - 1)
                return "bits of a sample";
            if (word(sample + 4) != 0)
                return "position of a sample";
            const bool isFloat = out_.format == 97;
            const uint32_t upper = isFloat ? 0x3f800000u : expected_.bits[i] == 64 ? 0xffffffffu : 0xffu;
            if (word(sample + 8) != (isFloat ? 0xbf800000u : 0u) || word(sample + 12) != upper)
                return "range of a sample";
            out_.channels.push_back(word(sample) >> 24);
            offset += expected_.bits[i];
        }
        return "";
    }

    std::string keyValues()
    {
        size_t at = word(56);
        const size_t end = at + word(60);
        std::string last;
        while (at < end) {
            const uint32_t length = word(at);
            if (length < 2 || at + 4 + length > end)
                return "length of a key and value";
            const std::string text(reinterpret_cast<const char*>(&bytes_[at + 4]), length);
            const size_t split = text.find('\0');
            if (split == std::string::npos || text.back() != '\0')
                return "a key or value that does not end";
            const std::string key = text.substr(0, split);
            if (key <= last)
                return "keys are not in order";
            last = key;
            out_.values[key] = text.substr(split + 1, length - split - 2);
            at += (4 + length + 3) / 4 * 4;
        }
        return at == end ? "" : "padding of key values";
    }

    std::string levels()
    {
        const uint64_t alignment = out_.scheme ? 1 : std::max(4u, expected_.blockBytes);
        uint64_t next = word(56) + word(60);
        out_.levels.resize(levelCount_);
        for (uint32_t l = levelCount_; l-- > 0;) {
            const size_t at = 80 + 24 * size_t(l);
            const uint64_t offset = longWord(at), length = longWord(at + 8), plain = longWord(at + 16);
            next = (next + alignment - 1) / alignment * alignment;
            if (offset != next || offset + length > bytes_.size())
                return fmt::format("level {} lies at {} instead of {}", l, offset, next);
            next = offset + length;
            const auto blocks = [&](uint32_t size) {
                return (std::max(size >> l, 1u) + expected_.blockSide - 1) / expected_.blockSide;
            };
            if (plain != uint64_t(blocks(out_.width)) * blocks(out_.height) * expected_.blockBytes)
                return fmt::format("level {} declares {} bytes", l, plain);
            out_.levels[l].resize(plain);
            if (!out_.scheme) {
                if (length != plain)
                    return "length of a level";
                std::memcpy(out_.levels[l].data(), &bytes_[offset], length);
            } else if (ZSTD_decompress(out_.levels[l].data(), plain, &bytes_[offset], length) != plain) {
                return fmt::format("level {} does not decompress", l);
            }
        }
        return next == bytes_.size() ? "" : "bytes behind the last level";
    }

    const std::vector<std::byte>& bytes_;
    Ktx2& out_;
    Expected expected_{};
    uint32_t levelCount_ = 0;
};

} // namespace

std::string readKtx2(const std::vector<std::byte>& bytes, Ktx2& result)
{
    return Reader(bytes, result).read();
}

} // namespace lumel::baker::test
