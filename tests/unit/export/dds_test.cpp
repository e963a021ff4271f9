// DDS files through OpenImageIO, which shares nothing with the writer.
#include "block_decoder.h"
#include "export/dds.h"
#include "sample.h"
#include <OpenImageIO/imageio.h>
#include <cstring>

namespace lumel::baker {
namespace {
using namespace test;

uint32_t wordAt(const std::vector<std::byte>& bytes, size_t at)
{
    uint32_t value;
    std::memcpy(&value, bytes.data() + at, 4);
    return value;
}

// Of all levels, as floats; channels as OpenImageIO finds them.
std::vector<Image> readBack(const std::filesystem::path& file)
{
    std::vector<Image> levels;
    const auto input = OIIO::ImageInput::open(file.string());
    EXPECT_TRUE(input) << OIIO::geterror();
    for (int level = 0; input && input->seek_subimage(0, level); ++level) {
        const OIIO::ImageSpec spec = input->spec();
        Image image(spec.width, spec.height, spec.nchannels);
        EXPECT_TRUE(
            input->read_image(0, level, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, image.pixels.data()))
            << input->geterror();
        levels.push_back(std::move(image));
    }
    return levels;
}

void expectReadBack(const ExportMap& map, TexelStorage storage, DdsHeader header, double leastPsnr)
{
    const Folder folder;
    const std::vector<std::byte> bytes = encodeDds(map, storage, header);
    std::ofstream(folder.path / "a.dds", std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
    const std::vector<Image> levels = readBack(folder.path / "a.dds");
    ASSERT_EQ(levels.size(), map.levels.size());
    for (size_t l = 0; l < levels.size(); ++l) {
        const Image &read = levels[l], &wanted = map.levels[l];
        ASSERT_EQ(read.width, wanted.width);
        ASSERT_EQ(read.height, wanted.height);
        double error = 0.0;
        size_t count = 0;
        for (int y = 0; y < wanted.height; ++y)
            for (int x = 0; x < wanted.width; ++x)
                for (int c = 0; c < std::min(read.channels, wanted.channels); ++c, ++count) {
                    error += std::pow(double(read.at(x, y)[c]) - wanted.at(x, y)[c], 2.0);
                }
        EXPECT_GT(psnr(error, count), leastPsnr) << "level " << l;
    }
}

// Of the formats of the DX10 header, OpenImageIO 2.4 reads blocks only.
TEST(Dds, OpenImageIoReadsEveryLevel)
{
    ExportMap normal = unevenMap(48, 20, 3);
    normal.isNormal = true;
    for (const DdsHeader header : {DdsHeader::dx10, DdsHeader::dx9}) {
        expectReadBack(unevenMap(48, 20, 1), TexelStorage::blocks, header, 44.0);
        expectReadBack(normal, TexelStorage::blocks, header, 44.0);
    }
    for (const int channels : {1, 3, 4})
        expectReadBack(unevenMap(48, 20, channels), TexelStorage::bytes, DdsHeader::dx9, 55.0);
}

TEST(Dds, LevelsFollowEachOther)
{
    for (const TexelStorage storage : {TexelStorage::bytes, TexelStorage::halves}) {
        const ExportMap map = unevenMap(48, 20, 4, true);
        const std::vector<std::byte> bytes = encodeDds(map, storage);
        auto at = bytes.begin() + 148;
        for (const Image& level : map.levels) {
            const std::vector<std::byte> texels = encodeTexels(level, formatOf(map, storage));
            ASSERT_LE(ptrdiff_t(texels.size()), bytes.end() - at);
            EXPECT_TRUE(std::equal(texels.begin(), texels.end(), at));
            at += ptrdiff_t(texels.size());
        }
        EXPECT_EQ(at, bytes.end());
    }
}

TEST(Dds, HeaderIsThatOfDirectX10)
{
    const struct {
        int channels;
        TexelStorage storage;
        uint32_t format;
    } cases[] = {{1, TexelStorage::bytes, 61},
                 {1, TexelStorage::blocks, 80},
                 {3, TexelStorage::bytes, 28},
                 {3, TexelStorage::halves, 10},
                 {4, TexelStorage::bytes, 28}};
    for (const auto& c : cases) {
        const ExportMap map = unevenMap(20, 12, c.channels);
        const std::vector<std::byte> bytes = encodeDds(map, c.storage);
        EXPECT_EQ(std::memcmp(bytes.data(), "DDS ", 4), 0);
        EXPECT_EQ(wordAt(bytes, 4), 124u);
        EXPECT_EQ(wordAt(bytes, 12), 12u); // height
        EXPECT_EQ(wordAt(bytes, 16), 20u);
        EXPECT_EQ(wordAt(bytes, 28), map.levels.size());
        EXPECT_EQ(std::memcmp(bytes.data() + 84, "DX10", 4), 0);
        EXPECT_EQ(wordAt(bytes, 128), c.format);
        EXPECT_EQ(wordAt(bytes, 132), 3u); // two-dimensional
        size_t size = 148;
        for (const Image& level : map.levels)
            size += bytesOfLevel(formatOf(map, c.storage), level.width, level.height);
        EXPECT_EQ(bytes.size(), size);
    }
}

TEST(Dds, NormalsKeepTwoChannelsInBlocks)
{
    ExportMap map = unevenMap(32, 32, 3);
    map.isNormal = true;
    const std::vector<std::byte> bytes = encodeDds(map, TexelStorage::blocks);
    EXPECT_EQ(wordAt(bytes, 128), 83u);
    size_t at = 148;
    for (const Image& level : map.levels) {
        const size_t size = bytesOfLevel(TexelFormat::bc5, level.width, level.height);
        const Image read = decodeBlocks(std::span(bytes).subspan(at, size), level.width, level.height, 2);
        double error = 0.0;
        for (int y = 0; y < level.height; ++y)
            for (int x = 0; x < level.width; ++x)
                for (int c = 0; c < 2; ++c)
                    error += std::pow(double(read.at(x, y)[c]) - level.at(x, y)[c], 2.0);
        EXPECT_GT(psnr(error, read.pixels.size()), 40.0);
        at += size;
    }
}

} // namespace
} // namespace lumel::baker
