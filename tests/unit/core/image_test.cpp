#include "core/error.h"
#include "core/file.h"
#include "core/image.h"
#include <cmath>
#include <cstring>
#include <fstream>
#include <gtest/gtest.h>
#include <unistd.h>
#include <webp/encode.h>
#include <zlib.h>

namespace lumel {
namespace {

namespace fs = std::filesystem;

struct Images : testing::Test {
    fs::path folder;

    Images()
    {
        std::string pattern = (fs::temp_directory_path() / "lumel-test-XXXXXX").string();
        folder = mkdtemp(pattern.data());
    }
    ~Images() override { fs::remove_all(folder); }

    static Image gradient(int width, int height, int channels)
    {
        Image image(width, height, channels);
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x)
                for (int c = 0; c < channels; ++c)
                    image.at(x, y)[c] = float((7 * x + 50 * y + 90 * c) % 256) / 255.0f;
        return image;
    }

    // One line, the file's name in it.
    static void expectRefused(const fs::path& file)
    {
        try {
            readImage(file);
            ADD_FAILURE() << file << " was read";
        } catch (const Error& e) {
            const std::string message = e.what();
            EXPECT_EQ(message.rfind(file.string(), 0), 0u) << message;
            EXPECT_EQ(message.find('\n'), std::string::npos) << message;
            EXPECT_NE(message.find("; "), std::string::npos) << "no remedy: " << message;
        }
    }
    fs::path write(const std::string& name, const std::string& bytes) const
    {
        std::ofstream(folder / name, std::ios::binary) << bytes;
        return folder / name;
    }
    static std::string text(const fs::path& file)
    {
        std::ifstream stream(file, std::ios::binary);
        return {std::istreambuf_iterator<char>(stream), {}};
    }
};

TEST_F(Images, PngKeepsEightBits)
{
    for (int channels : {1, 3}) {
        const Image image = gradient(13, 5, channels);
        writeImage(folder / "a.png", image);
        const Image read = readImage(folder / "a.png");
        ASSERT_EQ(read.width, 13);
        ASSERT_EQ(read.height, 5);
        ASSERT_EQ(read.channels, channels);
        for (size_t i = 0; i < image.pixels.size(); ++i)
            EXPECT_NEAR(read.pixels[i], image.pixels[i], 1e-6f) << channels;
    }
}

TEST_F(Images, ColoursAreNotMultipliedByAlpha)
{
    const Image image = gradient(13, 5, 4);
    writeImage(folder / "a.png", image);
    const Image fromFile = readImage(folder / "a.png"),
                fromMemory = readImage(readFile(folder / "a.png"), "memory");
    ASSERT_EQ(fromFile.channels, 4);
    for (size_t i = 0; i < image.pixels.size(); ++i) {
        EXPECT_NEAR(fromFile.pixels[i], image.pixels[i], 1e-6f);
        EXPECT_NEAR(fromMemory.pixels[i], image.pixels[i], 1e-6f);
    }
}

TEST_F(Images, ExrKeepsHalfFloatsBeyondOne)
{
    Image image(3, 1, 3);
    image.pixels = {0.0f, 1000.0f, -2.5f, 0.1f, 65504.0f, 6.1e-5f, 1.0f / 3.0f, 12.34f, 0.5f};
    writeImage(folder / "a.exr", image);
    const Image read = readImage(folder / "a.exr");
    ASSERT_EQ(read.pixels.size(), image.pixels.size());
    for (size_t i = 0; i < image.pixels.size(); ++i)
        EXPECT_NEAR(read.pixels[i], image.pixels[i], std::abs(image.pixels[i]) / 2048.0f + 1e-7f);
}

uint16_t halfOf(float value)
{
    uint16_t half = 0;
    floatsToHalf({&value, 1}, &half);
    return half;
}

float floatOf(uint16_t half)
{
    float value = 0.0f;
    halfToFloats({&half, 1}, &value);
    return value;
}

// IEEE 754-2008, binary16.
TEST(HalfFloats, AreReadExactly)
{
    for (unsigned half = 0; half < 0x7c00; ++half) {
        const unsigned exponent = half >> 10, mantissa = half & 0x3ffu;
        const float expected =
            std::ldexp(float(exponent == 0 ? mantissa : mantissa + 1024), int(std::max(exponent, 1u)) - 25);
        ASSERT_EQ(floatOf(uint16_t(half)), expected);
        ASSERT_EQ(floatOf(uint16_t(half | 0x8000)), -expected);
    }
    EXPECT_EQ(floatOf(0x7c00), INFINITY);
    EXPECT_EQ(floatOf(0xfc00), -INFINITY);
    EXPECT_TRUE(std::signbit(floatOf(0x8000)));
}

TEST(HalfFloats, AreTheNearest)
{
    constexpr uint16_t kInfinity = 0x7c00;
    for (uint16_t half = 0; half < kInfinity; ++half)
        for (const uint16_t sign : {0x0000, 0x8000}) {
            const uint16_t own = half | sign, next = own + 1;
            const float value = floatOf(own);
            ASSERT_EQ(halfOf(value), own);
            // Beyond the largest, infinity begins where the next half would be.
            const float middle =
                half + 1 < kInfinity ? 0.5f * (value + floatOf(next)) : std::copysign(65520.0f, value);
            ASSERT_EQ(halfOf(middle), half % 2 == 0 ? own : next);
            ASSERT_EQ(halfOf(std::nextafter(middle, 0.0f)), own);
            ASSERT_EQ(halfOf(std::nextafter(middle, 2.0f * middle)), next);
        }
    for (const float large : {65536.0f, 1e30f, INFINITY}) {
        EXPECT_EQ(halfOf(large), kInfinity);
        EXPECT_EQ(halfOf(-large), 0x8000 | kInfinity);
    }
    EXPECT_TRUE(std::isnan(floatOf(halfOf(NAN))));
}

TEST_F(Images, SameImageIsTheSameFile)
{
    for (const char* name : {"a.png", "a.exr"}) {
        writeImage(folder / name, gradient(40, 30, 3));
        const std::string first = text(folder / name);
        usleep(1'100'000); // time stamps count seconds
        writeImage(folder / name, gradient(40, 30, 3));
        EXPECT_TRUE(text(folder / name) == first) << name;
    }
}

TEST_F(Images, MemoryGivesTheSameAsTheFile)
{
    for (const char* name : {"a.png", "a.exr"}) {
        writeImage(folder / name, gradient(9, 9, 3));
        const auto bytes = readFile(folder / name);
        EXPECT_EQ(readImage(bytes, "memory").pixels, readImage(folder / name).pixels) << name;
    }
}

TEST_F(Images, UnknownFormatsAndFoldersAreRefusedWhenWriting)
{
    EXPECT_THROW(writeImage(folder / "a.xyz", gradient(2, 2, 3)), Error);
    EXPECT_THROW(writeImage(folder / "none" / "a.png", gradient(2, 2, 3)), Error);
    EXPECT_TRUE(fs::is_empty(folder));
}

TEST_F(Images, MissingFilesAndFoldersAreNamed)
{
    expectRefused(folder / "missing.png");
    fs::create_directory(folder / "folder.png");
    expectRefused(folder / "folder.png");
}

TEST_F(Images, EmptyFilesAreNamed)
{
    for (const char* name : {"a.png", "a.jpg", "a.exr", "a.tif"})
        expectRefused(write(name, ""));
}

TEST_F(Images, TextIsNamed)
{
    for (const char* name : {"a.png", "a.jpg", "a.exr", "a.tif", "a.txt", "a"})
        expectRefused(write(name, "This is a shopping list.\nMilk.\n"));
}

TEST_F(Images, TruncatedFilesAreNamed)
{
    for (const char* name : {"a.png", "a.exr"}) {
        writeImage(folder / name, gradient(64, 64, 3));
        const std::string whole = text(folder / name);
        for (double share : {0.02, 0.3, 0.6})
            expectRefused(write(name, whole.substr(0, size_t(share * double(whole.size())))));
    }
}

TEST_F(Images, TruncatedMemoryIsNamed)
{
    writeImage(folder / "a.png", gradient(64, 64, 3));
    const auto whole = readFile(folder / "a.png");
    for (size_t size : {size_t(0), size_t(3), size_t(20), whole.size() / 2}) {
        try {
            readImage(std::span(whole).first(size), "model.glb#image3");
            ADD_FAILURE() << size << " bytes were read";
        } catch (const Error& e) {
            EXPECT_EQ(std::string(e.what()).rfind("model.glb#image3", 0), 0u) << e.what();
        }
    }
}

TEST_F(Images, BombsAreRefusedBeforeMemoryIsTaken)
{
    // A PNG header (RFC 2083, section 4.1.1) that declares 65500 x 65500 pixels.
    std::string png("\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\xff\xdc\0\0\xff\xdc\x08\x02\0\0\0", 29);
    uint32_t crc = 0xffffffffu; // over "IHDR" and its data
    for (size_t i = 12; i < png.size(); ++i) {
        crc ^= uint8_t(png[i]);
        for (int k = 0; k < 8; ++k)
            crc = crc & 1 ? 0xedb88320u ^ (crc >> 1) : crc >> 1;
    }
    crc = ~crc;
    for (int shift = 24; shift >= 0; shift -= 8)
        png += char(crc >> shift);
    png += std::string("\0\0\0\x0aIDAT\x78\x9c\x63\0\0\0\1\0\1", 18);
    expectRefused(write("bomb.png", png));
}

TEST(Srgb, AgreesWithTheStandard)
{
    // IEC 61966-2-1: both branches, their joint, and a value of published tables.
    EXPECT_EQ(srgbToLinear(0.0f), 0.0f);
    EXPECT_FLOAT_EQ(srgbToLinear(1.0f), 1.0f);
    EXPECT_NEAR(srgbToLinear(188.0f / 255.0f), 0.502886f, 1e-5f);
    EXPECT_NEAR(srgbToLinear(0.02f), 0.02f / 12.92f, 1e-8f);
    EXPECT_NEAR(srgbToLinear(0.04045f), srgbToLinear(0.04046f), 2e-6f);
    EXPECT_NEAR(linearToSrgb(0.18f), 0.461356f, 1e-5f);
    EXPECT_NEAR(linearToSrgb(0.0031308f), linearToSrgb(0.0031309f), 2e-6f);
}

TEST(Srgb, BothFunctionsAreInverse)
{
    for (int i = 0; i <= 255; ++i) {
        const float encoded = float(i) / 255.0f;
        EXPECT_NEAR(linearToSrgb(srgbToLinear(encoded)), encoded, 1e-6f);
    }
    EXPECT_LT(srgbToLinear(-0.1f), 0.0f) << "negative values stay linear";
    EXPECT_FALSE(std::isnan(linearToSrgb(-0.1f)));
}

TEST_F(Images, WebpKeepsColoursApartFromAlpha)
{
    std::vector<uint8_t> rgba = {255, 0, 0, 255, 0, 200, 0, 128};
    uint8_t* encoded = nullptr;
    const size_t size = WebPEncodeLosslessRGBA(rgba.data(), 2, 1, 8, &encoded);
    ASSERT_GT(size, 0u);
    const std::string bytes(reinterpret_cast<const char*>(encoded), size);
    WebPFree(encoded);
    for (const char* name : {"image.webp", "image.png"}) { // by content in memory, by name on disk
        const Image image = readImage(std::as_bytes(std::span(bytes)), name);
        ASSERT_EQ(image.channels, 4);
        for (size_t i = 0; i < rgba.size(); ++i)
            EXPECT_FLOAT_EQ(image.pixels[i], float(rgba[i]) / 255.0f);
    }
    EXPECT_EQ(readImage(write("image.webp", bytes)).width, 2);
    for (size_t cut = 1; cut < bytes.size() - 1; ++cut)
        expectRefused(write("cut.webp", bytes.substr(0, cut)));
}

TEST_F(Images, BombsAreRefusedBeforeTheyAreDecoded)
{
    // A PNG of one row that declares 65500 x 65500, then one within the limit of size but not of bytes.
    writeImage(folder / "row.png", gradient(64, 1, 3));
    const std::string good = text(folder / "row.png");
    const auto declaring = [&](uint32_t width, uint32_t height) {
        std::string bomb = good;
        for (int i = 0; i < 4; ++i) {
            bomb[size_t(16 + i)] = char(width >> (24 - 8 * i) & 255);
            bomb[size_t(20 + i)] = char(height >> (24 - 8 * i) & 255);
        }
        const uint32_t crc = crc32(0, reinterpret_cast<const unsigned char*>(bomb.data()) + 12, 17);
        for (int i = 0; i < 4; ++i)
            bomb[size_t(29 + i)] = char(crc >> (24 - 8 * i) & 255);
        return bomb;
    };
    EXPECT_EQ(declaring(64, 1), good);
    expectRefused(write("bomb.png", declaring(65500, 65500)));
    expectRefused(write("bomb.png", declaring(16384, 16384)));
    // A solid WebP image of 16383 x 16383 pixels takes some 30 bytes.
    std::string webp = {'R', 'I', 'F', 'F', 26,  0,  0, 0, 'W', 'E', 'B',
                        'P', 'V', 'P', '8', 'L', 14, 0, 0, 0,   0x2f};
    webp += std::string("\xfe\xbf\xff\x0f", 4) + std::string(9, '\0');
    expectRefused(write("bomb.webp", webp));
}

TEST_F(Images, ExrHeadersThatDeclareTooMuchAreRefused)
{
    writeImage(folder / "good.exr", gradient(8, 8, 3));
    const std::string good = text(folder / "good.exr");
    EXPECT_EQ(readImage(folder / "good.exr").width, 8);
    const auto changed = [&](const std::string& attribute, size_t skip, uint32_t value) {
        std::string bytes = good;
        std::memcpy(bytes.data() + bytes.find(attribute) + attribute.size() + skip, &value, 4);
        expectRefused(write("changed.exr", bytes));
        EXPECT_THROW(readImage(std::as_bytes(std::span(bytes)), "memory"), Error);
    };
    const std::string window("dataWindow\0box2i\0", 17), lines("compression\0compression\0", 24);
    changed(window, 0, 0x7fffffff);           // an attribute of 2 GiB
    changed(lines, 0, uint32_t(good.size())); // one that ends past the file's end
    changed(window, 12, 0x7ffffffe);          // the last column
    changed(window, 4, 100);                  // the first column, right of the last
}

} // namespace
} // namespace lumel
