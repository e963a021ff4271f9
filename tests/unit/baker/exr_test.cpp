#include "core/error.h"
#include "core/file.h"
#include "maps.h"
#include <filesystem>
#include <fstream>

namespace lumel::baker {
namespace {
namespace fs = std::filesystem;
using namespace test;

struct Folder {
    fs::path path = fs::temp_directory_path() / ("lumel-exr-test-" + std::to_string(::getpid()));
    Folder() { fs::create_directories(path); }
    ~Folder() { fs::remove_all(path); }
};

ReflectanceMips sample(int w, int h)
{
    return bake(normalMaps(noiseNormals(w, h, 0.2f, 7), 80.0f), {});
}

// Every second texel above level 0 has a second lobe.
ReflectanceMips withSecondLobes(ReflectanceMips mips)
{
    for (size_t l = 1; l < mips.levels.size(); ++l) {
        Level& level = mips.levels[l];
        for (int i = 0; i < level.width * level.height; ++i) {
            const float lobe[kSecondChannels] = {-0.3f, 0.2f, 0.01f, 0.003f, 0.02f, 0.5f, 0.25f, 0.125f};
            level.second.insert(level.second.end(), i % 2 ? kNoSecondLobe : lobe,
                                (i % 2 ? kNoSecondLobe : lobe) + kSecondChannels);
        }
    }
    return mips;
}
} // namespace

TEST(BakedExr, SecondLobesRoundTripFromLevelOneOn)
{
    Folder folder;
    const ReflectanceMips mips = withSecondLobes(sample(13, 6));
    for (const bool asFloat : {false, true}) {
        writeExr(folder.path / "a.exr", mips, asFloat);
        const ImageFile header = readExrHeader(folder.path / "a.exr");
        EXPECT_EQ(header.channelNames.size(), size_t(kChannels) + size_t(kSecondChannels));
        const ReflectanceMips read = readExr(folder.path / "a.exr");
        EXPECT_TRUE(read.levels[0].second.empty());
        for (size_t l = 1; l < mips.levels.size(); ++l) {
            ASSERT_EQ(read.levels[l].second.size(), mips.levels[l].second.size());
            for (size_t i = 0; i < mips.levels[l].second.size(); ++i) {
                const float expected = mips.levels[l].second[i];
                ASSERT_NEAR(read.levels[l].second[i], expected,
                            asFloat ? 0.0f : std::max(1e-3f * std::abs(expected), 1e-6f));
            }
        }
    }
}

TEST(BakedExr, FilesOfOneLobeHaveItsChannelsOnly)
{
    Folder folder;
    writeExr(folder.path / "a.exr", sample(8, 8));
    EXPECT_EQ(readExrHeader(folder.path / "a.exr").channelNames.size(), size_t(kChannels));
    for (const Level& level : readExr(folder.path / "a.exr").levels)
        EXPECT_TRUE(level.second.empty());
}

TEST(BakedExr, TheVersionOfOneLobeIsRead)
{
    Folder folder;
    ReflectanceMips mips = sample(8, 8);
    mips.version = kOneLobeVersion;
    writeExr(folder.path / "old.exr", mips, true);
    const ReflectanceMips read = readExr(folder.path / "old.exr");
    EXPECT_EQ(read.version, kOneLobeVersion);
    EXPECT_EQ(read.levels[1].texels, mips.levels[1].texels);
    EXPECT_EQ(bakedSource(folder.path / "old.exr"), mips.source);
}

TEST(BakedExr, FilesThatDoNotTellTheirLobesHaveWhatTheirChannelsHold)
{
    Folder folder;
    ReflectanceMips mips = sample(8, 8);
    mips.lobes.clear();
    writeExr(folder.path / "old.exr", mips);
    EXPECT_EQ(readExr(folder.path / "old.exr").lobes, "1");
    writeExr(folder.path / "old.exr", withSecondLobes(mips));
    EXPECT_EQ(readExr(folder.path / "old.exr").lobes, "auto");
}

TEST(BakedExr, SecondLobesThatAreNoneAreRefused)
{
    Folder folder;
    ReflectanceMips mips = withSecondLobes(sample(8, 8));
    mips.levels[1].second[kS2xy] = 1.0f;
    writeExr(folder.path / "a.exr", mips, true);
    EXPECT_THROW(readExr(folder.path / "a.exr"), Error);
    mips.levels[1].second[kS2xy] = std::nanf("");
    writeExr(folder.path / "a.exr", mips, true);
    EXPECT_THROW(readExr(folder.path / "a.exr"), Error);
}

TEST(BakedExr, SecondLobesKeepTheirCovarianceAsHalves)
{
    float thin[kSecondChannels] = {
        0.7071f, 0.7072f, 0.5f * (1.0f + 1e-4f), 0.5f * (1.0f - 1e-4f), 0.5f * (1.0f + 1e-4f), 1e9f,
        0.0f,    0.0f};
    quantiseSecond(thin);
    EXPECT_LT(thin[kN2x] * thin[kN2x] + thin[kN2y] * thin[kN2y], 1.0f);
    EXPECT_GT(thin[kS2xx] * thin[kS2yy], thin[kS2xy] * thin[kS2xy]);
    EXPECT_FLOAT_EQ(thin[kKs2R], 65504.0f);
    float none[kSecondChannels];
    std::copy_n(kNoSecondLobe, +kSecondChannels, none);
    quantiseSecond(none);
    EXPECT_TRUE(std::equal(none, none + kSecondChannels, kNoSecondLobe));
}

TEST(BakedExr, RoundTripsAllLevelsAndMetadata)
{
    Folder folder;
    const ReflectanceMips mips = sample(13, 6);
    for (const bool asFloat : {false, true}) {
        writeExr(folder.path / "a.exr", mips, asFloat);
        const ReflectanceMips read = readExr(folder.path / "a.exr");
        ASSERT_EQ(read.levels.size(), mips.levels.size());
        EXPECT_EQ(read.model, mips.model);
        EXPECT_EQ(read.method, "fit");
        EXPECT_EQ(read.version, kVersion);
        EXPECT_EQ(read.source, mips.source);
        EXPECT_EQ(read.lobes, mips.lobes);
        EXPECT_FALSE(read.lobes.empty());
        const ReflectanceMips head = readExrMetadata(folder.path / "a.exr");
        EXPECT_EQ(std::tie(head.model, head.method, head.lobes, head.version, head.source),
                  std::tie(mips.model, mips.method, mips.lobes, mips.version, mips.source));
        EXPECT_TRUE(head.levels.empty());
        for (size_t l = 0; l < mips.levels.size(); ++l) {
            ASSERT_EQ(read.levels[l].width, mips.levels[l].width);
            ASSERT_EQ(read.levels[l].height, mips.levels[l].height);
            for (size_t i = 0; i < mips.levels[l].texels.size(); ++i) {
                const float expected = mips.levels[l].texels[i];
                const float tolerance = asFloat ? 0.0f : std::max(1e-3f * std::abs(expected), 1e-6f);
                ASSERT_NEAR(read.levels[l].texels[i], expected, tolerance);
            }
        }
    }
}

TEST(BakedExr, SameChainIsTheSameFile)
{
    Folder folder;
    const ReflectanceMips mips = sample(8, 8);
    writeExr(folder.path / "a.exr", mips);
    writeExr(folder.path / "b.exr", mips);
    EXPECT_EQ(readFile(folder.path / "a.exr"), readFile(folder.path / "b.exr"));
}

TEST(BakedExr, DamagedOrForeignFilesAreRefusedNotTrusted)
{
    Folder folder;
    const fs::path file = folder.path / "a.exr";
    EXPECT_THROW(readExr(file), Error) << "missing";
    std::ofstream(file) << "no picture";
    EXPECT_THROW(readExr(file), Error) << "text";
    writeImage(file, constantImage(4, 4, {0.1f, 0.2f, 0.3f}));
    EXPECT_THROW(readExr(file), Error) << "an ordinary picture";

    ReflectanceMips mips = sample(64, 64);
    writeExr(file, mips);
    const auto size = fs::file_size(file);
    for (const auto part : {size / 8, size / 2, size - 16}) {
        writeExr(file, mips);
        fs::resize_file(file, part);
        EXPECT_THROW(readExr(file), Error) << "cut at " << part << " of " << size;
    }
    mips.version = "0";
    writeExr(file, mips);
    EXPECT_THROW(readExr(file), Error) << "another version";
    mips.version = kVersion;
    mips.levels[2].texels[kSxx] = -1.0f;
    writeExr(file, mips, true);
    EXPECT_THROW(readExr(file), Error) << "a covariance that is none";
    mips = sample(64, 64);
    mips.levels[1].texels[kKsR] = std::nanf("");
    writeExr(file, mips, true);
    EXPECT_THROW(readExr(file), Error) << "not a number";
    mips = sample(64, 64);
    mips.levels.pop_back();
    writeExr(file, mips);
    EXPECT_THROW(readExr(file), Error) << "last level missing";
}

TEST(BakedExr, WriteFailuresLeaveNothingBehind)
{
    Folder folder;
    EXPECT_THROW(writeExr(folder.path / "none" / "a.exr", sample(2, 2)), Error);
    EXPECT_THROW(writeExr(folder.path / "a.exr", ReflectanceMips{}), Error);
    EXPECT_TRUE(fs::is_empty(folder.path));
}

TEST(BakedExr, NormalsAtTheHorizonStayInsideTheDisc)
{
    Folder folder;
    ReflectanceMips mips = sample(16, 16);
    for (int i = 0; i < 256; ++i) {
        float* texel = mips.levels[0].texels.data() + size_t(i) * kChannels;
        texel[kNx] = 0.99999f * std::cos(0.0246f * float(i)); // rounded to half, some pass 1
        texel[kNy] = 0.99999f * std::sin(0.0246f * float(i));
    }
    writeExr(folder.path / "a.exr", mips);
    EXPECT_NO_THROW(readExr(folder.path / "a.exr"));
}

TEST(BakedExr, ValuesBeyondHalfFloatStayLobes)
{
    Folder folder;
    ReflectanceMips mips = sample(2, 2);
    float* t = mips.levels[0].texels.data();
    t[kKsR] = 1e9f;
    // A lobe 100 times longer than wide at 45 degrees: rounding S to half would lose its determinant.
    t[kSxx] = t[kSyy] = 0.5f * (1.0f + 1e-4f);
    t[kSxy] = 0.5f * (1.0f - 1e-4f);
    writeExr(folder.path / "a.exr", mips);
    const ReflectanceMips read = readExr(folder.path / "a.exr");
    const float* r = read.levels[0].texels.data();
    EXPECT_FLOAT_EQ(r[kKsR], 65504.0f);
    EXPECT_GT(r[kSxx] * r[kSyy], r[kSxy] * r[kSxy]);
    EXPECT_NEAR(r[kSxy], t[kSxy], 1e-3f);
}
} // namespace lumel::baker
