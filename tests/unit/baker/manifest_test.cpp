#include "baker/manifest.h"
#include "core/error.h"
#include "core/file.h"
#include "maps.h"

namespace lumel::baker {
namespace {
using namespace test;
namespace fs = std::filesystem;
} // namespace

TEST(Manifest, BakesSkipsAndGoesOnAfterFailures)
{
    const fs::path folder = fs::temp_directory_path() / ("lumel-manifest-test-" + std::to_string(::getpid()));
    fs::create_directories(folder);
    writeImage(folder / "h.png", bumps(16, 16));
    writeImage(folder / "n.png", noiseNormals(8, 8, 0.2f, 1));
    writeFileAtomically(folder / "list.json", R"([
        {"output": "a.exr", "height": "h.png", "height_scale": 0.1, "power": 50, "specular": [1, 0.5, 0.2],
         "lobes": 2},
        {"output": "missing.exr", "normal": "none.png"},
        {"output": "typo.exr", "normal": "n.png", "powr": 3},
        {"output": "b.exr", "normal": "n.png", "normal_green": "down", "roughness": "h.png", "model": "blinn-phong",
         "reduce": 1}])");
    const ManifestResult first = bakeManifest(folder / "list.json", {});
    EXPECT_EQ(first.baked, 2u);
    EXPECT_EQ(first.upToDate, 0u);
    ASSERT_EQ(first.failures.size(), 2u);
    EXPECT_NE(first.failures[0].find("none.png"), std::string::npos);
    EXPECT_NE(first.failures[1].find("powr"), std::string::npos);
    EXPECT_EQ(readExr(folder / "b.exr").levels[0].width, 8);
    EXPECT_EQ(readExr(folder / "b.exr").model, "blinn-phong");
    EXPECT_FALSE(fs::exists(folder / "missing.exr"));
    EXPECT_FALSE(readExr(folder / "a.exr").levels[1].second.empty());
    EXPECT_TRUE(readExr(folder / "b.exr").levels[1].second.empty());

    EXPECT_EQ(bakeManifest(folder / "list.json", {}).upToDate, 2u);
    writeImage(folder / "h.png", bumps(8, 8)); // the height of one, the roughness of the other
    EXPECT_EQ(bakeManifest(folder / "list.json", {}).baked, 2u);
    for (const char* bad : {"", "{}", "[1]", "not json"}) {
        writeFileAtomically(folder / "bad.json", bad);
        try {
            EXPECT_EQ(bakeManifest(folder / "bad.json", {}).failures.size(), 1u) << bad;
        } catch (const Error& e) {
            EXPECT_NE(std::string(e.what()).find("bad.json"), std::string::npos);
        }
    }
    fs::remove_all(folder);
}
} // namespace lumel::baker
