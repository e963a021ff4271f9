// Any shader may read an upload at once, as synchronization validation checks.
#include "gpu/barrier.h"
#include "gpu/pipeline.h"
#include "gpu/resource.h"
#include "gpu/sampler.h"
#include "test_scene.h"

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

} // namespace
