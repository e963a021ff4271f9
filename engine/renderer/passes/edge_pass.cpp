#include "edge_pass.h"
#include "gpu/sampler.h"
#include <algorithm>

namespace lumel {
namespace {

// Edge pixels that are filtered at most: a third of the picture, or what one dispatch of groups of 64
// reaches.
uint32_t capacityFor(glm::uvec2 size)
{
    return std::min(size.x * size.y / 3 + 1, 64 * shared::kMostGroups);
}

} // namespace

bool filtersEdges(const Settings& settings)
{
    return settings.edgeFilter && settings.msaa == 1 && settings.shading != Shading::reference &&
           settings.view == View::none;
}

EdgePass::EdgePass(const gpu::Device& device, const SceneState& scene, const Targets& targets)
    : sampler_(gpu::makeSampler(device, {.filter = vk::Filter::eNearest})),
      layout_(
          gpu::makeSetLayout(device, {vk::DescriptorType::eCombinedImageSampler,
                                      vk::DescriptorType::eStorageImage, vk::DescriptorType::eStorageImage})),
      set_(gpu::makeSet(device, layout_)),
      blend_(gpu::makeComputePipeline(device, "edges_blend.comp", {*scene.frameSet().layout(), *layout_},
                                      sizeof(shared::EdgePush))),
      list_(device, sizeof(shared::EdgeList), gpu::Buffer::MemoryUsage::device, "edge list")
{
    connect(device, targets);
}

void EdgePass::connect(const gpu::Device& device, const Targets& targets)
{
    const auto write = [&](vk::DescriptorSet set, const gpu::Image& to) {
        gpu::writeSampled(device, set, 0, *sampler_, targets.hdr.view(), vk::ImageLayout::eGeneral);
        gpu::writeStorage(device, set, 1, targets.hdr.view());
        gpu::writeStorage(device, set, 2, to.view());
    };
    write(*set_, targets.display);
    if (targets.small) {
        smallSet_ = gpu::makeSet(device, layout_);
        write(*smallSet_, targets.small);
    }
}

EdgePass::Pipelines& EdgePass::pipelines(const Frame& frame)
{
    const auto toneMap = uint32_t(frame.settings.toneMap);
    Pipelines& pipelines = pipelines_[toneMap];
    if (!pipelines.find.handle.begun()) {
        const auto make = [&](const char* shader) {
            return gpu::makeComputePipeline(frame.device, shader,
                                            {*frame.scene.frameSet().layout(), *layout_},
                                            sizeof(shared::EdgePush), toneMap);
        };
        pipelines = {make("edges_find.comp"), make("edges_write.comp")};
    }
    return pipelines;
}

void EdgePass::prepare(const Frame& frame)
{
    pipelines(frame);
}

void EdgePass::record(Frame& frame)
{
    const vk::CommandBuffer commands = frame.commands;
    const gpu::Image& hdr = frame.targets.hdr;
    const Pipelines& pipelines = this->pipelines(frame);
    const uint32_t capacity = capacityFor(frame.settings.size);
    if (pixels_.size() < capacity * sizeof(shared::EdgePixel))
        pixels_ = gpu::Buffer(frame.device, capacity * sizeof(shared::EdgePixel),
                              gpu::Buffer::MemoryUsage::device, "edge pixels", "use a smaller --size");
    const shared::EdgeList none{.groups = {0, 1, 1}, .count = 0};
    commands.updateBuffer<shared::EdgeList>(list_.handle(), 0, none);
    gpu::memoryBarrier(commands, gpu::Use::transferWrite, gpu::Use::computeReadWrite);
    gpu::imageBarrier(commands, hdr.handle(), hdr.aspect(), gpu::Use::colorWrite, gpu::Use::general);
    const auto bind = [&](const gpu::Pipeline& pipeline) {
        bindSets(frame, vk::PipelineBindPoint::eCompute, pipeline,
                 {frame.renderSize != frame.settings.size ? *smallSet_ : *set_});
        pushConstants(commands, pipeline,
                      shared::EdgePush{.list = list_.address(),
                                       .pixels = pixels_.address(),
                                       .size = frame.renderSize,
                                       .capacity = capacity});
    };
    bind(pipelines.find);
    const glm::uvec2 blocks = (frame.renderSize + shared::kEdgeBlock - 1u) / shared::kEdgeBlock;
    commands.dispatch(groupsOf64(blocks.x), blocks.y, 1);
    gpu::memoryBarrier(commands, gpu::Use::computeWrite, gpu::Use::general);
    bind(blend_);
    commands.dispatchIndirect(list_.handle(), 0);
    gpu::memoryBarrier(commands, gpu::Use::general, gpu::Use::general);
    bind(pipelines.write);
    commands.dispatchIndirect(list_.handle(), 0);
    gpu::imageBarrier(commands, hdr.handle(), hdr.aspect(), gpu::Use::general, gpu::Use::computeSample);
}

} // namespace lumel
