// Which Vulkan devices the program finds, how they are named, and sizes that need more than one row of
// workgroups.
#include "inputs.h"
#include "program.h"

namespace lumel::cli {
namespace {

namespace fs = std::filesystem;

class Devices : public Program {
protected:
    Outcome shotOn(const std::string& device, const std::string& size = "32x32")
    {
        writeScene(folder_ / "square.gltf", squareScene(folder_ / "square.gltf"));
        return run(
            {"shot", "square.gltf", "-o", "out.png", "--size", size, "--device", device, "--msaa", "4"});
    }
};

// Debian's chromium-common puts it where the Vulkan loader does not look. It comes last: whoever names no
// device gets another.
TEST_F(Devices, SwiftShaderIsFoundAndComesLast)
{
    if (!fs::exists("/usr/lib/chromium/vk_swiftshader_icd.json"))
        GTEST_SKIP() << "install chromium-common";
    const Outcome list = run({"view", "--list-devices"});
    ASSERT_EQ(list.exitCode, 0) << list.err;
    EXPECT_EQ(list.out.rfind("0 ", 0), 0u) << list.out;
    const size_t found = list.out.find("SwiftShader");
    ASSERT_NE(found, std::string::npos) << list.out;
    EXPECT_EQ(list.out.find('\n', found), list.out.size() - 1) << list.out;

    const Outcome shot = shotOn("swiftshader");
    EXPECT_EQ(shot.exitCode, 0) << shot.err;
    EXPECT_NE(shot.out.find("on SwiftShader"), std::string::npos) << shot.out;

    // It allocates 1 GiB at most; four samples of 8192 x 8192 pixels in half floats are twice that.
    const Outcome large = shotOn("swiftshader", "8192x8192");
    expectOneLine(large, 1,
                  "has maxMemoryAllocationSize 1073741824, 2147483648 needed: use a smaller --size");
    EXPECT_EQ(large.err.find("baked"), std::string::npos) << large.err;
}

TEST_F(Devices, LavapipeHasTheNameOfItsDriver)
{
    const Outcome shot = shotOn("Lavapipe");
    EXPECT_EQ(shot.exitCode, 0) << shot.err;
    EXPECT_NE(shot.out.find("on llvmpipe"), std::string::npos) << shot.out;
}

TEST_F(Devices, AnUnknownOneIsRefusedBeforeAnythingIsBaked)
{
    expectOneLine(shotOn("abacus"), 1, "no usable device named abacus");
    expectOneLine(shotOn("99"), 1, "no usable device named 99");
}

// 3840 x 2160 samples are 129600 workgroups of 64, more than one dimension of a dispatch has to take.
TEST_F(Devices, PicturesOfFourKAreValid)
{
    writeScene(folder_ / "square.gltf", squareScene(folder_ / "square.gltf"));
    const Outcome shot = run({"shot", "square.gltf", "-o", "out.png", "--size", "3840x2160", "--msaa", "1",
                              "--level-offset", "3", "--validate"});
    EXPECT_EQ(shot.exitCode, 0) << shot.err;
}

} // namespace
} // namespace lumel::cli
