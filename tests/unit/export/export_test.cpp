// Whole exports: the files of a folder, read back.
#include "core/error.h"
#include "export/export.h"
#include "ktx2_reader.h"
#include "sample.h"
#include <set>

namespace lumel::baker {
namespace {
using namespace test;
namespace fs = std::filesystem;

std::set<std::string> namesIn(const fs::path& folder)
{
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder))
        names.insert(entry.path().filename().string());
    return names;
}

nlohmann::json jsonIn(const fs::path& file)
{
    std::ifstream stream(file);
    return nlohmann::json::parse(stream);
}

void write(const ReflectanceMips& mips, const ExportOptions& options, const fs::path& folder)
{
    StagedFiles files(folder);
    exportMips({.name = "rock", .bakedFile = "rock.exr", .mips = mips}, options, files);
    files.publish();
}

class Export : public ::testing::Test {
protected:
    Folder folder;
    ReflectanceMips mips = bake(unevenMaps(24, 10), {});
    ExportOptions options;
};

TEST_F(Export, PicturesHoldEveryLevelAsFitted)
{
    const auto maps = makeMaps(fitGgx(mips, {}), {});
    for (const ExportFormat format : {ExportFormat::png, ExportFormat::exr}) {
        options.format = format;
        const bool asExr = format == ExportFormat::exr;
        write(mips, options, folder.path / (asExr ? "exr" : "png"));
        for (const ExportMap& map : maps)
            for (size_t l = 0; l < map.levels.size(); ++l) {
                const Image read =
                    readImage(folder.path / (asExr ? "exr" : "png") /
                              fmt::format("rock_{}_{:02}.{}", map.name, l, asExr ? "exr" : "png"));
                ASSERT_EQ(read.width, map.levels[l].width);
                ASSERT_EQ(read.height, map.levels[l].height);
                for (size_t i = 0; i < read.pixels.size(); ++i) {
                    float wanted = map.levels[l].pixels[i];
                    if (!asExr && map.colourSpace == ColourSpace::srgb)
                        wanted = linearToSrgb(wanted);
                    ASSERT_NEAR(read.pixels[i], wanted, asExr ? 5e-4f : 0.5f / 255.0f + 1e-5f) << map.name;
                }
            }
    }
}

TEST_F(Export, DescriptionNamesFilesChannelsAndErrors)
{
    for (const ExportFormat format :
         {ExportFormat::gltf, ExportFormat::glb, ExportFormat::dds, ExportFormat::ktx2, ExportFormat::png}) {
        options.format = format;
        options.ktx2Beside = true;
        const fs::path into = folder.path / std::to_string(int(format));
        write(mips, options, into);
        const nlohmann::json json = jsonIn(into / "rock.json");
        std::set<std::string> named{"rock.json"};
        for (const auto& map : json.at("maps")) {
            for (const std::string file : map.at("files"))
                EXPECT_TRUE(named.insert(file).second);
            for (const auto& channel : map.at("channels"))
                EXPECT_FALSE(channel.at("meaning").get<std::string>().empty());
        }
        for (const std::string file : json.value("files", nlohmann::json::array()))
            EXPECT_TRUE(named.insert(file).second);
        EXPECT_EQ(namesIn(into), named);
        ASSERT_EQ(json.at("levels").size(), mips.levels.size());
        for (const auto& level : json.at("levels"))
            EXPECT_LE(level.at("error").at("mean"), level.at("error").at("mean_of_averaged_maps"));
    }
}

TEST_F(Export, GltfTakesKtx2FilesBeside)
{
    options.format = ExportFormat::glb;
    options.ktx2Beside = true;
    write(mips, options, folder.path / "out");
    std::ifstream stream(folder.path / "out/rock_normal.ktx2", std::ios::binary);
    const std::string text((std::istreambuf_iterator<char>(stream)), {});
    const auto bytes = std::as_bytes(std::span(text));
    Ktx2 read;
    EXPECT_EQ(readKtx2({bytes.begin(), bytes.end()}, read), "");
    EXPECT_EQ(read.levels.size(), mips.levels.size());
}

TEST_F(Export, TheSameChainIsTheSameFile)
{
    write(mips, options, folder.path / "a");
    write(mips, options, folder.path / "b");
    for (const std::string& name : namesIn(folder.path / "a")) {
        const auto bytes = [&](const char* where) {
            std::ifstream stream(folder.path / where / name, std::ios::binary);
            return std::string((std::istreambuf_iterator<char>(stream)), {});
        };
        EXPECT_EQ(bytes("a"), bytes("b")) << name;
    }
}

TEST(StagedFiles, AppearTogetherOrNotAtAll)
{
    const Folder folder;
    {
        StagedFiles files(folder.path / "new");
        files.write("a.txt", std::string("a"));
        EXPECT_FALSE(fs::exists(folder.path / "new/a.txt"));
    }
    EXPECT_FALSE(fs::exists(folder.path / "new"));
    {
        StagedFiles files(folder.path / "new");
        files.write("a.txt", std::string("a"));
        files.write("b.txt", std::string("b"));
        files.publish();
    }
    EXPECT_EQ(namesIn(folder.path / "new"), std::set<std::string>({"a.txt", "b.txt"}));
    fs::create_directory(folder.path / "new/c.txt");
    StagedFiles blocked(folder.path / "new");
    blocked.write("b.txt", std::string("new"));
    blocked.write("c.txt", std::string("c"));
    EXPECT_THROW(blocked.publish(), Error);
    EXPECT_EQ(fs::file_size(folder.path / "new/b.txt"), 1u);
    EXPECT_THROW(StagedFiles(folder.path / "none/below"), Error);
    EXPECT_THROW(StagedFiles(folder.path / "new/a.txt"), Error);
}

} // namespace
} // namespace lumel::baker
