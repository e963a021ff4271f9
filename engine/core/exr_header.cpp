// "OpenEXR File Layout": magic, version, then attributes (name, type, size, value), an empty name last. A
// file of several parts has several headers, an empty one last.
#include "exr_header.h"
#include "error.h"
#include "image.h"
#include <cstring>
#include <fmt/format.h>
#include <istream>
#include <map>

namespace lumel {
namespace {

constexpr size_t kMaxTileTexels = size_t(1) << 22;

class HeaderCheck {
public:
    HeaderCheck(std::istream& stream, size_t size, const std::string& name)
        : stream_(stream), size_(size), name_(name)
    {
    }

    void run()
    {
        constexpr uint32_t kMagic = 20000630, kMultiPart = 0x1000;
        uint32_t start[2] = {};
        if (!read(start, sizeof start) || start[0] != kMagic)
            return;
        do {
            while (readAttribute()) {
            }
        } while ((start[1] & kMultiPart) && stream_.peek() > 0);
    }

private:
    [[noreturn]] void fail() const
    {
        throw Error(fmt::format("{}: damaged EXR header; export it again", name_));
    }

    bool read(void* to, size_t count)
    {
        return bool(stream_.read(static_cast<char*>(to), static_cast<std::streamsize>(count)));
    }

    std::string readName()
    {
        constexpr size_t kLongest = 256; // with the final 0
        std::string text;
        for (int c = stream_.get(); c > 0; c = stream_.get()) {
            text += char(c);
            if (text.size() > kLongest)
                fail();
        }
        return text;
    }

    // False at the end of a header.
    bool readAttribute()
    {
        const std::string attribute = readName();
        if (!stream_)
            fail();
        if (attribute.empty())
            return false;
        const std::string type = readName();
        uint32_t size = 0;
        if (!read(&size, sizeof size))
            fail();
        const size_t at = size_t(stream_.tellg());
        if (at > size_ || size > size_ - at)
            fail();
        checkSize(type, at, size);
        stream_.seekg(std::streamoff(at));
        if (attribute == "tiles")
            checkTiles(size);
        else if (attribute == "dataWindow")
            checkWindow(size);
        stream_.seekg(std::streamoff(at + size));
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
        if (!stream_ || size_t(stream_.tellg()) != at + size)
            fail();
    }

    void skipChannels()
    {
        constexpr std::streamoff kChannelBytes = 16;
        while (stream_ && !readName().empty())
            stream_.seekg(kChannelBytes, std::ios::cur);
    }

    void skipStrings(size_t end)
    {
        while (stream_ && size_t(stream_.tellg()) < end) {
            uint32_t length = 0;
            if (!read(&length, sizeof length) || length > end)
                fail();
            stream_.seekg(std::streamoff(length), std::ios::cur);
        }
    }

    void skipPreview(uint32_t size)
    {
        uint32_t extent[2] = {};
        if (!read(extent, sizeof extent) ||
            uint64_t(extent[0]) * extent[1] * 4 != uint64_t(size) - sizeof extent)
            fail();
        stream_.seekg(std::streamoff(size - sizeof extent), std::ios::cur);
    }

    void checkTiles(uint32_t size)
    {
        uint32_t tile[2] = {};
        if (size < sizeof tile || !read(tile, sizeof tile))
            fail();
        if (size_t(tile[0]) * size_t(tile[1]) > kMaxTileTexels)
            fail();
    }

    void checkWindow(uint32_t size)
    {
        int32_t box[4] = {}; // first and last column and row
        if (size < sizeof box || !read(box, sizeof box))
            fail();
        const int64_t width = int64_t(box[2]) - box[0] + 1, height = int64_t(box[3]) - box[1] + 1;
        if (width < 1 || height < 1)
            fail();
        checkImageSize(size_t(width), size_t(height), 1, size_, name_);
    }

    std::istream& stream_;
    size_t size_;
    const std::string& name_;
};

} // namespace

void checkExrHeader(std::istream& stream, size_t size, const std::string& name)
{
    HeaderCheck(stream, size, name).run();
}

} // namespace lumel
