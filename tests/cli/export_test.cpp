// lumel export: files, messages and what is left behind.
#include "core/image.h"
#include "inputs.h"
#include "program.h"
#include <set>

namespace lumel::cli {
namespace {

namespace fs = std::filesystem;

class ExportCommand : public Program {
protected:
    void SetUp() override
    {
        Program::SetUp();
        writeHeightMap(folder_ / "h.png", 24, 16);
        const Outcome outcome =
            run({"bake", "--height", "h.png", "--height-scale", "0.02", "-o", "rock.exr"});
        ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
    }

    std::set<std::string> filesIn(const fs::path& folder) const
    {
        std::set<std::string> names;
        for (const auto& entry : fs::directory_iterator(folder_ / folder))
            names.insert(entry.path().filename().string());
        return names;
    }
};

TEST_F(ExportCommand, WritesWhatEachFormatNeeds)
{
    const struct {
        std::vector<std::string> options;
        std::set<std::string> files;
    } cases[] = {
        {{"--to", "dds"},
         {"rock.json", "rock_normal.dds", "rock_roughness.dds", "rock_metallic.dds", "rock_base_color.dds",
          "rock_specular.dds"}},
        {{"--to", "ktx2", "--zstd", "--anisotropy"},
         {"rock.json", "rock_normal.ktx2", "rock_metallic_roughness.ktx2", "rock_anisotropy.ktx2",
          "rock_base_color.ktx2", "rock_specular.ktx2"}},
        {{"--to", "glb"}, {"rock.json", "rock.glb"}},
        {{"--to", "gltf", "--packing", "orm"},
         {"rock.json", "rock.gltf", "rock.bin", "rock_normal.png", "rock_occlusion_roughness_metallic.png",
          "rock_base_color.png"}},
    };
    for (const auto& c : cases) {
        std::vector<std::string> words{"export", "rock.exr", "-o", "out"};
        words.insert(words.end(), c.options.begin(), c.options.end());
        const Outcome outcome = run(words);
        EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
        EXPECT_EQ(outcome.err, "");
        EXPECT_NE(outcome.out.find("out: "), std::string::npos);
        EXPECT_EQ(filesIn("out"), c.files);
        fs::remove_all(folder_ / "out");
    }
}

TEST_F(ExportCommand, OneFileALevelAsPictures)
{
    EXPECT_EQ(run({"export", "rock.exr", "-o", "out", "--to", "png", "--name", "stone"}).exitCode, 0);
    for (const char* file :
         {"stone.json", "stone_normal_00.png", "stone_normal_04.png", "stone_metallic_roughness_03.png"})
        EXPECT_TRUE(fs::exists(folder_ / "out" / file)) << file;
    EXPECT_FALSE(fs::exists(folder_ / "out/stone_normal_05.png")); // 24 x 16 has five levels
}

TEST_F(ExportCommand, ExportedGltfIsRendered)
{
    ASSERT_EQ(run({"export", "rock.exr", "-o", "out", "--to", "glb"}).exitCode, 0);
    const Outcome outcome = run({"shot", "out/rock.glb", "-o", "a.png", "--size", "64x64"});
    EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
}

TEST_F(ExportCommand, FilesThatLumelDidNotBakeFail)
{
    writeText(folder_ / "notes.exr", "This is not a picture.\n");
    expectOneLine(run({"export", "notes.exr", "-o", "out"}), 1, "notes.exr");
    writeImage(folder_ / "plain.exr", Image(8, 8, 3)); // without levels
    expectOneLine(run({"export", "plain.exr", "-o", "out"}), 1, "plain.exr");
    writeImage(folder_ / "twelve.exr", Image(8, 8, 12));
    expectOneLine(run({"export", "twelve.exr", "-o", "out"}), 1, "twelve.exr");
    expectOneLine(run({"export", "h.png", "-o", "out"}), 1, "h.png");
    expectOneLine(run({"export", "nowhere.exr", "-o", "out"}), 1, "nowhere.exr");
    EXPECT_FALSE(fs::exists(folder_ / "out"));
}

TEST_F(ExportCommand, DamagedChainsFail)
{
    const std::string bytes = readText(folder_ / "rock.exr");
    writeText(folder_ / "cut.exr", bytes.substr(0, bytes.size() * 2 / 3)); // its last levels are missing
    expectOneLine(run({"export", "cut.exr", "-o", "out"}), 1, "cut.exr");
    EXPECT_FALSE(fs::exists(folder_ / "out"));
}

TEST_F(ExportCommand, FoldersThatCannotBeWrittenFail)
{
    writeText(folder_ / "taken", "a file");
    expectOneLine(run({"export", "rock.exr", "-o", "taken"}), 1, "taken: is a file");
    expectOneLine(run({"export", "rock.exr", "-o", "none/out"}), 1, "none/out");
    EXPECT_FALSE(fs::exists(folder_ / "none"));
    fs::create_directories(folder_ / "out/rock.json");
    expectOneLine(run({"export", "rock.exr", "-o", "out"}), 1, "rock.json");
    EXPECT_EQ(filesIn("out"), std::set<std::string>({"rock.json"}));
}

TEST_F(ExportCommand, UsageErrorsExitWithTwo)
{
    expectOneLine(run({"export", "rock.exr"}), 2, "--output");
    expectOneLine(run({"export", "-o", "out"}), 2, "baked");
    expectOneLine(run({"export", "rock.exr", "-o", "out", "--to", "bmp"}), 2, "--to");
    expectOneLine(run({"export", "rock.exr", "-o", "out", "--to", "dds", "--zstd"}), 2, "--zstd");
    expectOneLine(run({"export", "rock.exr", "-o", "out", "--textures", "ktx2"}), 2, "--textures");
    expectOneLine(run({"export", "rock.exr", "-o", "out", "--to", "png", "--texels", "half"}), 2, "--texels");
    expectOneLine(run({"export", "rock.exr", "-o", "out", "--to", "glb", "--packing", "unity"}), 2,
                  "--packing");
    expectOneLine(run({"export", "rock.exr", "-o", "out", "--name", "a/b"}), 2, "--name");
    EXPECT_FALSE(fs::exists(folder_ / "out"));
}

} // namespace
} // namespace lumel::cli
