#include "block_decoder.h"
#include "export/ktx2.h"
#include "ktx2_reader.h"
#include "sample.h"

namespace lumel::baker {
namespace {
using namespace test;

TEST(Ktx2, EveryFormatIsWrittenAsTheSpecificationSays)
{
    const struct {
        int channels;
        bool srgb, isNormal;
        TexelStorage storage;
        uint32_t format;
        std::vector<uint32_t> samples;
    } cases[] = {{1, false, false, TexelStorage::bytes, 9, {0}},
                 {3, false, false, TexelStorage::bytes, 37, {0, 1, 2, 15}},
                 {3, true, false, TexelStorage::bytes, 43, {0, 1, 2, 15 | 0x10}},
                 {3, false, false, TexelStorage::halves, 97, {0xc0, 0xc1, 0xc2, 0xcf}},
                 {1, false, false, TexelStorage::blocks, 139, {0}},
                 {3, false, true, TexelStorage::blocks, 141, {0, 1}}};
    for (const auto& c : cases)
        for (const bool zstandard : {false, true}) {
            ExportMap map = unevenMap(53, 18, c.channels, c.srgb);
            map.isNormal = c.isNormal;
            Ktx2 read;
            ASSERT_EQ(readKtx2(encodeKtx2(map, c.storage, zstandard), read), "") << c.format;
            EXPECT_EQ(read.format, c.format);
            EXPECT_EQ(read.width, 53u);
            EXPECT_EQ(read.height, 18u);
            EXPECT_EQ(read.channels, c.samples);
            EXPECT_EQ(read.values.at("KTXorientation"), "rd");
            for (size_t l = 0; l < map.levels.size(); ++l)
                EXPECT_EQ(read.levels[l], encodeTexels(map.levels[l], formatOf(map, c.storage)));
        }
}

TEST(Ktx2, EachLevelHoldsItsOwnTexels)
{
    const ExportMap map = unevenMap(32, 32, 4);
    Ktx2 read;
    ASSERT_EQ(readKtx2(encodeKtx2(map, TexelStorage::bytes, false), read), "");
    for (size_t l = 0; l < map.levels.size(); ++l)
        for (size_t c = 0; c < 4; ++c)
            EXPECT_NEAR(float(read.levels[l][c]) / 255.0f, map.levels[l].pixels[c], 0.5f / 255.0f + 1e-6f);
}

TEST(Ktx2, SupercompressionMakesSmoothMapsSmaller)
{
    const ExportMap map = unevenMap(128, 128, 4);
    EXPECT_LT(encodeKtx2(map, TexelStorage::bytes, true).size(),
              encodeKtx2(map, TexelStorage::bytes, false).size());
}

} // namespace
} // namespace lumel::baker
