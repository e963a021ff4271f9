// The file that pipelines are kept in: what is not this device's, or not whole, counts as nothing.
#include "core/error.h"
#include "core/file.h"
#include "gpu/pipeline_cache.h"
#include "test_scene.h"
#include <fstream>

using namespace lumel;
using namespace lumel::test;

namespace {

namespace fs = std::filesystem;

struct PipelineFile : testing::Test {
    fs::path folder, file;
    vk::PhysicalDeviceProperties properties;

    PipelineFile()
    {
        std::string pattern = (fs::temp_directory_path() / "lumel-test-XXXXXX").string();
        folder = mkdtemp(pattern.data());
        file = folder / "pipelines";
        properties.vendorID = 7;
        properties.deviceID = 8;
        properties.pipelineCacheUUID[3] = 9;
    }
    ~PipelineFile() override { fs::remove_all(folder); }

    std::vector<std::byte> data() const
    {
        VkPipelineCacheHeaderVersionOne header{};
        header.headerSize = sizeof header;
        header.headerVersion = VK_PIPELINE_CACHE_HEADER_VERSION_ONE;
        header.vendorID = properties.vendorID;
        header.deviceID = properties.deviceID;
        std::memcpy(header.pipelineCacheUUID, properties.pipelineCacheUUID.data(), VK_UUID_SIZE);
        std::vector<std::byte> bytes(sizeof header + 100, std::byte(1));
        std::memcpy(bytes.data(), &header, sizeof header);
        return bytes;
    }
    void writeText(const std::string& text) const { std::ofstream(file, std::ios::binary) << text; }
};

TEST_F(PipelineFile, GivesBackWhatWasWritten)
{
    EXPECT_TRUE(gpu::readPipelineData(file, properties).empty()) << "missing";
    gpu::writePipelineData(file, data());
    EXPECT_EQ(gpu::readPipelineData(file, properties), data());
}

TEST_F(PipelineFile, OfAnotherDeviceIsIgnored)
{
    gpu::writePipelineData(file, data());
    for (const auto change : {+[](vk::PhysicalDeviceProperties& p) { ++p.vendorID; },
                              +[](vk::PhysicalDeviceProperties& p) { ++p.deviceID; },
                              +[](vk::PhysicalDeviceProperties& p) { ++p.pipelineCacheUUID[15]; }}) {
        vk::PhysicalDeviceProperties other = properties;
        change(other);
        EXPECT_TRUE(gpu::readPipelineData(file, other).empty());
    }
}

TEST_F(PipelineFile, DamagedIsIgnored)
{
    gpu::writePipelineData(file, data());
    std::ifstream stream(file, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(stream), {}};
    std::string flipped = text;
    flipped[flipped.size() - 5] ^= 0x10;
    for (const std::string& damage :
         {std::string(), text.substr(0, 20), text.substr(0, text.size() / 2), flipped, text + "more"}) {
        writeText(damage);
        EXPECT_TRUE(gpu::readPipelineData(file, properties).empty());
    }
    fs::remove(file);
    fs::create_directory(file);
    EXPECT_TRUE(gpu::readPipelineData(file, properties).empty());
}

// Pipelines of a device that keeps them, and of one that found them.
TEST(PipelineCache, ServesTheNextDevice)
{
    std::string folder = (fs::temp_directory_path() / "lumel-test-XXXXXX").string();
    folder = mkdtemp(folder.data());
    const char* before = getenv("XDG_CACHE_HOME");
    const std::string restored = before ? before : "";
    setenv("XDG_CACHE_HOME", folder.c_str(), 1);
    for (int run = 0; run < 2; ++run) {
        const gpu::Device device({.keepPipelines = true});
        const gpu::Pipeline pipeline =
            gpu::makeComputePipeline(device, "budget.comp", {}, sizeof(shared::PlanPush));
        EXPECT_TRUE(*pipeline.handle);
    }
    EXPECT_EQ(std::distance(fs::directory_iterator(fs::path(folder) / "lumel"), {}), 1);
    before ? setenv("XDG_CACHE_HOME", restored.c_str(), 1) : unsetenv("XDG_CACHE_HOME");
    fs::remove_all(folder);
}

} // namespace
