#include "feedback_pass.h"
#include "renderer/resources/culling.h"
#include "vertex_input.h"

namespace lumel {
namespace {

gpu::Image makeTarget(const gpu::Device& device, glm::uvec2 size, vk::Format format,
                      vk::ImageUsageFlags usage)
{
    return {device,
            {.format = format,
             .width = size.x,
             .height = size.y,
             .usage = usage,
             .remedy = "use a smaller --size"},
            "feedback"};
}

// Offset of sample centres in full-size pixels from their block's centre: the pixels of a block of `size` x
// `size`, a power of two, in an order that spreads (bit-reversed Morton).
glm::vec2 jitterInPixels(uint32_t size, uint64_t frame)
{
    glm::uvec2 pixel(0);
    for (uint32_t half = size / 2; half > 0; half /= 2, frame >>= 2u) {
        pixel.x += half * uint32_t((frame ^ frame >> 1u) & 1u);
        pixel.y += half * uint32_t(frame & 1u);
    }
    return glm::vec2(pixel) - 0.5f * float(size - 1);
}

glm::uvec2 samplesOf(const Frame& frame, uint32_t divisor)
{
    return (frame.renderSize + divisor - 1u) / divisor;
}

} // namespace

FeedbackPass::FeedbackPass(const gpu::Device& device, glm::uvec2 size, const SceneState& scene)
    : layout_(gpu::makeSetLayout(device, {vk::DescriptorType::eStorageImage})),
      set_(gpu::makeSet(device, layout_)),
      raster_(gpu::makeGraphicsPipeline(
          device, {.vertex = "feedback.vert",
                   .fragment = "feedback.frag",
                   .bindings = kMeshBindings,
                   .attributes = meshAttributes(
                       {shared::kAttributePosition, shared::kAttributeUv, shared::kAttributeWorld}),
                   .sets = {*scene.frameSet().layout()},
                   .pushBytes = sizeof(shared::FeedbackPush),
                   .color = vk::Format::eR32G32B32A32Uint})),
      count_(gpu::makeComputePipeline(device, "feedback.comp", {*scene.frameSet().layout(), *layout_},
                                      sizeof(shared::FeedbackPush))),
      list_(device, scene.objects().size()), objectCount_(scene.objects().size()),
      objects_(device, std::vector(objectCount_, shared::ObjectFeedback{shared::kNotSeen, 0}), "feedback",
               gpu::FrameRing::kMostFrames),
      total_(device, std::vector{shared::FeedbackTotal{}}, "feedback total", gpu::FrameRing::kMostFrames)
{
    resize(device, size);
}

void FeedbackPass::resize(const gpu::Device& device, glm::uvec2 size)
{
    using Usage = vk::ImageUsageFlagBits;
    seen_ =
        makeTarget(device, size, vk::Format::eR32G32B32A32Uint, Usage::eColorAttachment | Usage::eStorage);
    depth_ = makeTarget(device, size, vk::Format::eD32Sfloat, Usage::eDepthStencilAttachment);
    gpu::writeStorage(device, *set_, 0, seen_.view());
    frame_ = 0;
}

bool FeedbackPass::serveAgain(const Frame& frame, uint32_t divisor)
{
    const uint32_t frames = frame.index - frame_; // that have drawn by them
    if (frame_ == 0 || served_ + 1 != frame.index || divisor != kSparse || divisor_ != kSparse ||
        samples_ != samplesOf(frame, divisor) || frames >= kMostFrames)
        return false;
    if (frames >= kLeastFrames &&
        motionInPixels(frame.scene.objects(), frame.inView, clipFromObject_, frame.clipFromWorld,
                       frame.renderSize) > kMostMotion * float(frame.renderSize.y))
        return false;
    served_ = frame.index;
    return true;
}

void FeedbackPass::record(Frame& frame, uint32_t divisor)
{
    divisor_ = divisor;
    samples_ = samplesOf(frame, divisor);
    frame_ = served_ = frame.index;
    late_ = frame.late;
    const auto& objects = frame.scene.objects();
    clipFromObject_.clear();
    for (const GpuObject& object : objects)
        clipFromObject_.push_back(frame.clipFromWorld * object.data.worldFromObject);
    const PassScope scope(frame, "feedback");
    const vk::CommandBuffer commands = frame.commands;
    const vk::Extent2D extent{samples_.x, samples_.y}; // a part of the images
    gpu::imageBarrier(commands, seen_.handle(), seen_.aspect(), gpu::Use::undefined, gpu::Use::colorWrite);
    gpu::imageBarrier(commands, depth_.handle(), depth_.aspect(), gpu::Use::undefined, gpu::Use::depthWrite);
    const vk::RenderingAttachmentInfo color{.imageView = seen_.view(),
                                            .imageLayout = vk::ImageLayout::eColorAttachmentOptimal,
                                            .loadOp = vk::AttachmentLoadOp::eClear,
                                            .storeOp = vk::AttachmentStoreOp::eStore};
    // What hides others and what is seen: all but blended objects, which let everything through.
    std::vector<uint32_t> solid;
    std::vector<size_t> masked; // last: their hidden samples cost a depth test, no lookup
    for (size_t i = 0; i < frame.inView.size(); ++i)
        if (frame.inView[i] && !objects[i].blend) {
            if (objects[i].data.flags & shared::kObjectMask)
                masked.push_back(i);
            else
                solid.push_back(uint32_t(i));
        }
    list_.write(frame, std::move(solid));
    beginRendering(commands, color, depth_.view(), extent);
    drawObjects(frame, masked);
    commands.endRendering();

    gpu::imageBarrier(commands, seen_.handle(), seen_.aspect(), gpu::Use::colorWrite, gpu::Use::computeRead);
    count(frame);
}

void FeedbackPass::prepare(const Frame& frame)
{
    for (const SurfaceKind& kind : frame.scene.surfaceKinds())
        if (kind.mask)
            maskPipeline(frame, kind.features & shared::kFeatureColoured);
}

const gpu::Pipeline& FeedbackPass::maskPipeline(const Frame& frame, bool coloured)
{
    const uint32_t features = coloured ? shared::kFeatureColoured : 0u;
    gpu::Pipeline& mask = masks_[features];
    if (!mask.handle.begun())
        mask = gpu::makeGraphicsPipeline(
            frame.device,
            {.vertex = "feedback_mask.vert",
             .fragment = "feedback_mask.frag",
             .bindings = kMeshBindings,
             .attributes = meshAttributes({shared::kAttributePosition, shared::kAttributeUv,
                                           shared::kAttributeMaterialUv, shared::kAttributeWorld}),
             .sets = {*frame.scene.frameSet().layout(), *frame.scene.materialLayout()},
             .pushBytes = sizeof(shared::FeedbackPush),
             .color = vk::Format::eR32G32B32A32Uint,
             .features = features});
    return mask;
}

void FeedbackPass::drawObjects(Frame& frame, std::span<const size_t> masked)
{
    // Samples stand for whole blocks, also where the picture's size is no multiple of theirs: the viewport
    // reaches past its edge by the same share.
    const glm::vec2 pixels = jitterInPixels(divisor_, frame.index);
    shared::FeedbackPush push{.objects = objects_.address(),
                              .total = total_.address(),
                              .jitter = pixels,
                              .divisor = float(divisor_),
                              .object = 0,
                              .size = samples_};
    bindSets(frame, vk::PipelineBindPoint::eGraphics, raster_);
    pushConstants(frame.commands, raster_, push);
    list_.draw(frame);
    for (const size_t i : masked) {
        const GpuObject& object = frame.scene.objects()[i];
        const gpu::Pipeline& pipeline = maskPipeline(frame, object.coloured);
        bindSets(frame, vk::PipelineBindPoint::eGraphics, pipeline, {*object.material->set});
        push.object = uint32_t(i);
        pushConstants(frame.commands, pipeline, push);
        drawTriangles(frame, i);
    }
}

void FeedbackPass::recount(Frame& frame)
{
    const PassScope scope(frame, "feedback");
    count(frame);
}

void FeedbackPass::count(Frame& frame)
{
    gpu::Counters::recordReset(frame.commands, {&objects_, &total_});
    bindSets(frame, vk::PipelineBindPoint::eCompute, count_, {*set_});
    pushConstants(frame.commands, count_,
                  shared::FeedbackPush{.objects = objects_.address(),
                                       .total = total_.address(),
                                       .jitter = {},
                                       .divisor = float(divisor_),
                                       .object = 0,
                                       .size = samples_});
    dispatchList(frame.commands, samples_.x * samples_.y);
    gpu::Counters::recordRead(frame.commands, {&objects_, &total_}, frame.place);
}

Feedback FeedbackPass::read(uint32_t place) const
{
    Feedback found;
    const auto* needs = objects_.read<shared::ObjectFeedback>(place);
    found.objects.assign(needs, needs + objectCount_);
    const auto& total = *total_.read<shared::FeedbackTotal>(place);
    for (size_t i = 0; i < found.elongations.size(); ++i)
        found.elongations[i] = float(double(uint64_t(total.carries[i]) << 32 | total.elongations[i]) /
                                     double(shared::kFeedbackScale));
    return found;
}

void FeedbackPass::apply(const Feedback& feedback, Frame& frame)
{
    const auto& objects = frame.scene.objects();
    frame.feedback.resize(objects.size());
    for (size_t i = 0; i < objects.size(); ++i) {
        const shared::ObjectFeedback& need = feedback.objects[i];
        frame.feedback[i] = {.inView = frame.inView[i] != 0,
                             .visible = frame.inView[i] && need.level != shared::kNotSeen,
                             .lightable = objects[i].texelMap != nullptr,
                             .level =
                                 float(need.level) / float(shared::kFeedbackScale) + shared::kFeedbackFinest,
                             .samples = need.samples,
                             .coarsest = objects[i].texelMap ? float(objects[i].texelMap->coarsest) : 0.0f,
                             .litSize = objects[i].data.litSize};
    }
}

} // namespace lumel
