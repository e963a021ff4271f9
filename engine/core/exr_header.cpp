// "OpenEXR File Layout": magic, version, then attributes (name, type, size, value), an empty name last. A
// file of several parts has several headers, an empty one last.
#include "exr_header.h"
#include "error.h"
#include "image.h"
#include <cstring>
#include <fmt/format.h>
#include <map>

namespace lumel {
namespace {

constexpr size_t kMaxTileTexels = size_t(1) << 22;

class HeaderCheck {
public:
    explicit HeaderCheck(std::span<const std::byte> bytes) : bytes_(bytes) {}

    void run()
    {
        constexpr uint32_t kMagic = 20000630, kMultiPart = 0x1000;
        uint32_t start[2] = {};
        read(start, sizeof start);
        if (start[0] != kMagic)
            fail();
        do {
            while (readAttribute()) {
            }
        } while ((start[1] & kMultiPart) && at_ < bytes_.size() && bytes_[at_] != std::byte(0));
    }

private:
    [[noreturn]] static void fail() { throw Error("damaged EXR header; export it again"); }

    void read(void* to, size_t count)
    {
        const size_t from = at_;
        skip(count);
        std::memcpy(to, bytes_.data() + from, count);
    }

    void skip(size_t count)
    {
        if (count > bytes_.size() - at_)
            fail();
        at_ += count;
    }

    std::string readName()
    {
        constexpr size_t kLongest = 256; // with the final 0
        std::string text;
        for (char c = 0; read(&c, 1), c != 0;) {
            text += c;
            if (text.size() > kLongest)
                fail();
        }
        return text;
    }

    // False at the end of a header.
    bool readAttribute()
    {
        const std::string attribute = readName();
        if (attribute.empty())
            return false;
        const std::string type = readName();
        uint32_t size = 0;
        read(&size, sizeof size);
        const size_t at = at_;
        if (size > bytes_.size() - at)
            fail();
        checkSize(type, at, size);
        at_ = at;
        if (attribute == "tiles")
            checkTiles(size);
        else if (attribute == "dataWindow")
            checkWindow(size);
        at_ = at + size;
        return true;
    }

    // OpenEXR takes as many bytes as the type needs, whatever the size says, and goes on from there.
    void checkSize(const std::string& type, size_t at, uint32_t size)
    {
        static const std::map<std::string, uint32_t> fixed = {{"box2i", 16},
                                                              {"box2f", 16},
                                                              {"chromaticities", 32},
                                                              {"compression", 1},
                                                              {"deepImageState", 1},
                                                              {"double", 8},
                                                              {"envmap", 1},
                                                              {"float", 4},
                                                              {"int", 4},
                                                              {"keycode", 28},
                                                              {"lineOrder", 1},
                                                              {"m33f", 36},
                                                              {"m44f", 64},
                                                              {"m33d", 72},
                                                              {"m44d", 128},
                                                              {"rational", 8},
                                                              {"tiledesc", 9},
                                                              {"timecode", 8},
                                                              {"v2i", 8},
                                                              {"v2f", 8},
                                                              {"v2d", 16},
                                                              {"v3i", 12},
                                                              {"v3f", 12},
                                                              {"v3d", 24}};
        const auto found = fixed.find(type);
        if (found != fixed.end() && found->second != size)
            fail();
        if (type == "chlist")
            skipChannels();
        else if (type == "stringvector")
            skipStrings(at + size);
        else if (type == "preview")
            skipPreview(size);
        else
            return;
        if (at_ != at + size)
            fail();
    }

    void skipChannels()
    {
        constexpr size_t kChannelBytes = 16;
        while (!readName().empty())
            skip(kChannelBytes);
    }

    void skipStrings(size_t end)
    {
        while (at_ < end) {
            uint32_t length = 0;
            read(&length, sizeof length);
            skip(length);
        }
    }

    void skipPreview(uint32_t size)
    {
        uint32_t extent[2] = {};
        read(extent, sizeof extent);
        const uint64_t pixels = uint64_t(extent[0]) * extent[1];
        if (size < sizeof extent || pixels > size || 4 * pixels != size - sizeof extent)
            fail();
        skip(size - sizeof extent);
    }

    void checkTiles(uint32_t size)
    {
        uint32_t tile[2] = {};
        if (size < sizeof tile)
            fail();
        read(tile, sizeof tile);
        if (size_t(tile[0]) * size_t(tile[1]) > kMaxTileTexels)
            fail();
    }

    void checkWindow(uint32_t size)
    {
        int32_t box[4] = {}; // first and last column and row
        if (size < sizeof box)
            fail();
        read(box, sizeof box);
        const int64_t width = int64_t(box[2]) - box[0] + 1, height = int64_t(box[3]) - box[1] + 1;
        if (width < 1 || height < 1)
            fail();
        checkImageSize(size_t(width), size_t(height), 1, bytes_.size());
    }

    std::span<const std::byte> bytes_;
    size_t at_ = 0; // never past the end
};

} // namespace

void checkExrHeader(std::span<const std::byte> bytes)
{
    HeaderCheck(bytes).run();
}

} // namespace lumel
