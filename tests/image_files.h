// Image files of every format that is read, and of some that are refused, generated.
#pragma once
#include <OpenImageIO/imageio.h>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <string>

namespace lumel::test {

inline constexpr std::array kReadEndings = {"png", "jpg", "webp", "exr", "hdr", "tif", "tga"};

inline std::string bytesOf(const std::filesystem::path& file)
{
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

inline std::filesystem::path writeBytes(const std::filesystem::path& file, const std::string& bytes)
{
    std::ofstream(file, std::ios::binary) << bytes;
    return file;
}

// Metadata as cameras and painting programs write it, whose readers are weaker than those of pixels.
inline void addMetadata(OIIO::ImageSpec& spec, const std::string& ending)
{
    spec.attribute("ImageDescription", "slopes and grain");
    spec.attribute("Exif:ExposureTime", 0.01f);
    spec.attribute("Exif:UserComment", "none");
    spec.attribute("IPTC:Caption", "slopes and grain");
    spec.attribute("GPS:Latitude", 1.0f);
    std::array<uint8_t, 400> profile;
    for (size_t i = 0; i < profile.size(); ++i)
        profile[i] = uint8_t(i * 7);
    if (ending == ".jpg" || ending == ".tif") // PNG's writer looks into it
        spec.attribute("ICCProfile", OIIO::TypeDesc(OIIO::TypeDesc::UINT8, int(profile.size())),
                       profile.data());
}

// Slopes and grain in three channels, by OpenImageIO's writer for the file's ending.
inline void writeImageFile(const std::filesystem::path& file, int width, int height,
                           OIIO::TypeDesc type = OIIO::TypeDesc::UINT8, bool withMetadata = false)
{
    std::vector<float> pixels(size_t(width) * size_t(height) * 3);
    uint32_t random = 1;
    for (size_t i = 0; i < pixels.size(); ++i) {
        random = random * 1664525u + 1013904223u; // Numerical Recipes' generator
        pixels[i] =
            0.7f * float(i % (3 * size_t(width))) / float(3 * width) + 0.3f * float(random >> 8) * 0x1p-24f;
    }
    const auto output = OIIO::ImageOutput::create(file.string());
    ASSERT_TRUE(output) << file;
    OIIO::ImageSpec spec(width, height, 3, type);
    if (withMetadata)
        addMetadata(spec, file.extension().string());
    ASSERT_TRUE(output->open(file.string(), spec) &&
                output->write_image(OIIO::TypeDesc::FLOAT, pixels.data()) && output->close())
        << output->geterror();
}

// A progressive JPEG (ITU-T T.81) of side x side grey pixels whose coefficients come again and again: 40
// bytes and a millisecond for each of the scans if the side is 4096.
inline std::string jpegBomb(int side, int scans)
{
    const auto word = [](int value) { return std::string{char(value >> 8), char(value)}; };
    const size_t blocks = size_t(side / 8) * size_t(side / 8);
    std::string bytes = "\xff\xd8";
    bytes += std::string("\xff\xdb\0\x43\0", 5) + std::string(64, '\1'); // quantisation
    bytes += std::string("\xff\xc2\0\x0b\x08", 5) + word(side) + word(side) + std::string("\1\1\x11\0", 4);
    // Each Huffman table has one code of one bit: no difference, and a run of 2^14 empty blocks.
    bytes += std::string("\xff\xc4\0\x14\0\1", 6) + std::string(16, '\0');
    bytes += std::string("\xff\xc4\0\x14\x10\1", 6) + std::string(15, '\0') + '\xe0';
    bytes += std::string("\xff\xda\0\x08\1\1\0\0\0\0", 10) + std::string(blocks / 8, '\0');
    for (int scan = 0; scan < scans; ++scan)
        bytes += std::string("\xff\xda\0\x08\1\1\0\1\x3f\0", 10) +
                 std::string(((blocks + 16383) / 16384 * 15 + 7) / 8, '\0');
    return bytes + "\xff\xd9";
}

// The PNG file with metadata nested so deep that OpenImageIO 2.4's reader of it runs out of stack.
inline std::string withNestedMetadata(const std::string& png)
{
    constexpr int kDepth = 200000;
    std::string xml = "<x:xmpmeta xmlns:x=\"adobe:ns:meta/\"><rdf:RDF xmlns:rdf=\"http://www.w3.org/1999/02/"
                      "22-rdf-syntax-ns#\"><rdf:Description>";
    for (const char* tag : {"<rdf:Seq>", "</rdf:Seq>"})
        for (int i = 0; i < kDepth; ++i)
            xml += tag;
    xml += "</rdf:Description></rdf:RDF></x:xmpmeta>";
    const auto word = [](uint32_t value) {
        return std::string{char(value >> 24), char(value >> 16), char(value >> 8), char(value)};
    };
    const std::string data = std::string("iTXtXML:com.adobe.xmp\0\0\0\0\0", 26) + xml;
    uint32_t crc = 0xffffffffu; // RFC 2083, section 3.4: over a chunk's name and data
    for (const char c : data) {
        crc ^= uint8_t(c);
        for (int bit = 0; bit < 8; ++bit)
            crc = crc & 1 ? 0xedb88320u ^ (crc >> 1) : crc >> 1;
    }
    constexpr size_t kHeader = 33; // signature and IHDR
    return png.substr(0, kHeader) + word(uint32_t(data.size() - 4)) + data + word(~crc) + png.substr(kHeader);
}

// The first bytes of formats that OpenImageIO would read, with as much behind them.
inline std::string foreignFile(const std::string& format, const std::filesystem::path& folder)
{
    if (format == "dds")
        return std::string("DDS \x7c\0\0\0\x07\x10\0\0\x04\0\0\0\x04\0\0\0", 20) +
               std::string(108 + 64, '\x20');
    const std::filesystem::path file = folder / ("foreign." + format);
    writeImageFile(file, 16, 16);
    std::string bytes = bytesOf(file);
    std::filesystem::remove(file);
    return bytes;
}

} // namespace lumel::test
