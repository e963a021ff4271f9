#include "block_decoder.h"
#include "export/texels.h"
#include "sample.h"

namespace lumel::baker {
namespace {
using namespace test;

TEST(Texels, BlocksDecodeToTheMap)
{
    for (const int channels : {1, 2}) {
        const ExportMap map = unevenMap(61, 34, channels);
        for (const Image& level : map.levels) {
            const TexelFormat format = channels == 1 ? TexelFormat::bc4 : TexelFormat::bc5;
            const std::vector<std::byte> bytes = encodeTexels(level, format);
            ASSERT_EQ(bytes.size(), bytesOfLevel(format, level.width, level.height));
            const Image decoded = decodeBlocks(bytes, level.width, level.height, channels);
            double error = 0.0;
            for (size_t i = 0; i < level.pixels.size(); ++i)
                error += std::pow(double(decoded.pixels[i]) - level.pixels[i], 2.0);
            EXPECT_GT(psnr(error, level.pixels.size()), 40.0) << level.width;
        }
    }
}

TEST(Texels, BytesRoundAndSrgbIsEncoded)
{
    Image image(2, 1, 3);
    image.pixels = {0.0f, 1.0f, 0.2159f, 2.0f, -1.0f, 0.5f};
    const auto at = [](const std::vector<std::byte>& bytes, size_t i) { return int(bytes[i]); };
    const auto linear = encodeTexels(image, TexelFormat::rgba8);
    const auto srgb = encodeTexels(image, TexelFormat::rgba8Srgb);
    EXPECT_EQ(at(linear, 2), 55);
    EXPECT_EQ(at(srgb, 2), 128);
    EXPECT_EQ(at(linear, 3), 255); // no alpha
    EXPECT_EQ(at(srgb, 4), 255);
    EXPECT_EQ(at(srgb, 5), 0);
    EXPECT_EQ(at(linear, 6), 128);
}

TEST(Texels, HalvesKeepElevenBits)
{
    const ExportMap map = unevenMap(8, 8, 4);
    const auto bytes = encodeTexels(map.levels[0], TexelFormat::rgba16f);
    std::vector<float> values(map.levels[0].pixels.size());
    halfToFloats(std::span(reinterpret_cast<const uint16_t*>(bytes.data()), values.size()), values.data());
    for (size_t i = 0; i < values.size(); ++i)
        EXPECT_NEAR(values[i], map.levels[0].pixels[i], 5e-4f);
}

TEST(Texels, FormatsSuitTheMap)
{
    ExportMap normal = unevenMap(4, 4, 3);
    normal.isNormal = true;
    EXPECT_EQ(formatOf(normal, TexelStorage::blocks), TexelFormat::bc5);
    EXPECT_EQ(formatOf(normal, TexelStorage::bytes), TexelFormat::rgba8);
    EXPECT_EQ(formatOf(unevenMap(4, 4, 1), TexelStorage::blocks), TexelFormat::bc4);
    EXPECT_EQ(formatOf(unevenMap(4, 4, 1), TexelStorage::bytes), TexelFormat::r8);
    EXPECT_EQ(formatOf(unevenMap(4, 4, 3, true), TexelStorage::blocks), TexelFormat::rgba8Srgb);
    EXPECT_EQ(formatOf(unevenMap(4, 4, 1), TexelStorage::halves), TexelFormat::rgba16f);
}

} // namespace
} // namespace lumel::baker
