// Uploads: any shader may read them at once, as synchronization validation checks; many take few submissions.
#include "gpu/barrier.h"
#include "gpu/pipeline.h"
#include "gpu/sampler.h"
#include "gpu/upload.h"
#include "renderer/demands.h"
#include "test_scene.h"
#include <random>
#include <thread>

using namespace lumel;
using namespace lumel::test;

namespace {

class UploadTest : public GpuTest {};

gpu::Buffer staged(size_t bytes)
{
    gpu::Buffer staging(device(), bytes, gpu::Buffer::MemoryUsage::host, "staging");
    std::memset(staging.mapped<void>(), 0, bytes);
    return staging;
}

// The display pass, for one: its view from a buffer and its picture from an image that were uploaded just
// before.
TEST_F(UploadTest, ComputeReadsWhatWasJustUploaded)
{
    using Type = vk::DescriptorType;
    const auto frameLayout = gpu::makeSetLayout(device(), {Type::eUniformBuffer});
    const auto layout = gpu::makeSetLayout(device(), {Type::eCombinedImageSampler, Type::eStorageImage});
    const auto frameSet = gpu::makeSet(device(), frameLayout), set = gpu::makeSet(device(), layout);
    const gpu::Buffer view(device(), sizeof(shared::View), gpu::Buffer::MemoryUsage::device, "view");
    using Usage = vk::ImageUsageFlagBits;
    const gpu::Image source(
        device(), {.width = 64, .height = 1, .usage = Usage::eSampled | Usage::eTransferDst}, "source");
    const gpu::Image shown(device(),
                           {.format = vk::Format::eR8G8B8A8Unorm,
                            .width = 64,
                            .height = 1,
                            .usage = Usage::eStorage | Usage::eTransferSrc},
                           "shown");
    const vk::raii::Sampler sampler = gpu::makeSampler(device());
    gpu::writeUniform(device(), *frameSet, 0, view.handle());
    gpu::writeSampled(device(), *set, 0, *sampler, source.view());
    gpu::writeStorage(device(), *set, 1, shown.view());
    const gpu::Pipeline pipeline = gpu::makeComputePipeline(device(), "display.comp", {*frameLayout, *layout},
                                                            sizeof(shared::DisplayPush));
    const gpu::Buffer viewData = staged(sizeof(shared::View)), texels = staged(64 * 8);
    device().runOnce([&](vk::CommandBuffer commands) {
        gpu::recordUpload(commands, viewData, view);
        gpu::recordUpload(
            commands, texels, source,
            {{.imageSubresource = {vk::ImageAspectFlagBits::eColor, 0, 0, 1}, .imageExtent = {64, 1, 1}}});
        gpu::imageBarrier(commands, shown.handle(), shown.aspect(), gpu::Use::undefined,
                          gpu::Use::computeWrite);
        commands.bindPipeline(vk::PipelineBindPoint::eCompute, *pipeline.handle);
        commands.bindDescriptorSets(vk::PipelineBindPoint::eCompute, *pipeline.layout, 0, {*frameSet, *set},
                                    nullptr);
        pushConstants(commands, pipeline, shared::DisplayPush{.weight = 1.0f, .size = {64, 1}});
        commands.dispatch(1, 1, 1);
        gpu::imageBarrier(commands, shown.handle(), shown.aspect(), gpu::Use::computeWrite,
                          gpu::Use::transferRead);
    });
    const auto bytes = gpu::readBack(device(), shown, 4, vk::ImageLayout::eTransferSrcOptimal);
    EXPECT_EQ(bytes[0], std::byte(0));
    EXPECT_EQ(bytes[3], std::byte(255)); // alpha
}

// As where the CPU sees no device memory.
gpu::Device makeStagingDevice()
{
    const char* wanted = std::getenv("LUMEL_DEVICE");
    return gpu::Device(forRendering({.device = wanted ? wanted : "", .validation = true, .stage = true}));
}

template<class T>
std::vector<T> randomWords(size_t count, unsigned seed)
{
    std::mt19937 random(seed);
    std::vector<T> words(count);
    for (T& word : words)
        word = T(random() & 0x3bffu); // a finite half float
    return words;
}

// Parts of 8 MiB are filled to the last byte, and larger buffers cut.
TEST(StagedUpload, BuffersOfAnySizeArriveWhole)
{
    const gpu::Device device = makeStagingDevice();
    const std::vector<size_t> sizes = {1, 3, 1000, 5'000'001, 4, 2'097'152, 77};
    std::vector<std::vector<uint32_t>> contents;
    std::vector<gpu::Buffer> buffers;
    const uint64_t before = device.submissions();
    {
        gpu::UploadBatch batch(device);
        for (const size_t size : sizes) {
            contents.push_back(randomWords<uint32_t>(size, unsigned(size)));
            buffers.push_back(batch.buffer(contents.back(), "words"));
        }
        batch.finish();
    }
    EXPECT_EQ(device.submissions() - before, 4u); // 27 MiB
    for (size_t i = 0; i < sizes.size(); ++i) {
        const auto bytes = gpu::readBack(device, buffers[i], 4 * sizes[i]);
        EXPECT_EQ(std::memcmp(bytes.data(), contents[i].data(), bytes.size()), 0) << sizes[i];
    }
    EXPECT_EQ(device.validationMessages(), std::vector<std::string>{});
}

TEST(StagedUpload, PicturesAreTheSame)
{
    const TestScene s = sphereScene(bumpyMaps(128, 0.3f, 50.0f));
    const scene::Camera camera = cameraAt({0.0f, 0.0f, 3.0f});
    const gpu::Device staging = makeStagingDevice();
    ASSERT_TRUE(staging.stages());
    for (const Shading shading : {Shading::tsl, Shading::forward}) {
        Renderer renderer(staging, s.scene, s.materials, settingsFor(shading));
        renderer.render(camera);
        EXPECT_EQ(renderer.readDisplay().pixels, shoot(s, camera, settingsFor(shading)).display.pixels);
    }
    EXPECT_EQ(staging.validationMessages(), std::vector<std::string>{});
}

// As the viewer's loader may; validation checks that no handle is used by two threads at a time.
TEST_F(UploadTest, AnotherThreadUploadsWhileFramesAreRendered)
{
    const TestScene s = sphereScene(bumpyMaps(64, 0.3f, 50.0f));
    const scene::Camera camera = cameraAt({0.0f, 0.0f, 3.0f});
    const Image alone = shoot(s, camera, settingsFor(Shading::tsl)).display;
    Renderer renderer(device(), s.scene, s.materials, settingsFor(Shading::tsl));
    std::atomic<bool> rendered = false;
    SceneResources resources;
    int uploads = 0;
    std::jthread loader([&] {
        for (; uploads < 2 || !rendered; ++uploads)
            resources = uploadScene(device(), s.scene, s.materials);
    });
    for (int i = 0; i < 20; ++i) {
        renderer.restart();
        renderer.render(camera);
        EXPECT_EQ(renderer.readDisplay().pixels, alone.pixels);
    }
    rendered = true;
    loader.join();
    Renderer of(device(), s.scene, resources, settingsFor(Shading::tsl));
    of.render(camera);
    EXPECT_EQ(of.readDisplay().pixels, alone.pixels);
}

// One allocation a resource met the limit of many drivers, 4096, with some 680 materials.
TEST_F(UploadTest, SevenHundredMaterialsTakeFewAllocationsAndSubmissions)
{
    TestScene s = sphereScene(bumpyMaps(64, 0.3f, 50.0f));
    const scene::Object object = s.scene.objects[0];
    const scene::Material material = s.scene.materials[0];
    const scene::BakedMaterial baked = s.materials[0];
    for (int i = 1; i < 700; ++i) {
        s.scene.materials.push_back(material);
        s.materials.push_back(baked);
        s.scene.objects.push_back(object);
        s.scene.objects.back().material = i;
        s.scene.objects.back().worldFromObject[3] = glm::vec4(i % 30 - 15, i / 30 - 12, -40, 1);
    }
    const gpu::MemoryReport before = device().memory().report();
    const uint64_t submissions = device().submissions();
    const SceneResources resources = uploadScene(device(), s.scene, s.materials);
    EXPECT_LE(device().submissions() - submissions, 16u);
    Renderer renderer(device(), s.scene, resources, settingsFor(Shading::tsl));
    const FrameStats stats = renderer.render(cameraAt({0.0f, 0.0f, 3.0f}));
    EXPECT_EQ(stats.objectsCulled, 0u);
    EXPECT_LT(stats.memory.allocations, before.allocations + 100);
    EXPECT_GT(stats.memory.of(gpu::MemoryKind::materials), before.of(gpu::MemoryKind::materials));
}

} // namespace
