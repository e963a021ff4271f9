// What every pass of one frame works on.
#pragma once
#include "core/pass_names.h"
#include "gpu/barrier.h"
#include "gpu/timer.h"
#include "renderer/resources/scene_state.h"
#include "renderer/resources/targets.h"
#include "tsl/detail.h"
#include "tsl/residency.h"
#include <optional>
#include <span>

namespace lumel {

// What a command buffer has bound. Binding it again for each of hundreds of draws would cost more than
// drawing.
struct BoundState {
    struct Point {
        vk::Pipeline pipeline;
        std::array<vk::DescriptorSet, 4> sets;
    } graphics, compute;
    vk::Buffer vertices, indices;
    uint32_t firstVertex = 0;
    std::optional<vk::CullModeFlags> cullMode;
    std::optional<vk::FrontFace> frontFace;
};

struct Frame {
    const gpu::Device& device;
    vk::CommandBuffer commands;
    gpu::Timer& timer;
    gpu::FrameRing& ring;
    SceneState& scene;
    Targets& targets;
    const Settings& settings;
    glm::uvec2 renderSize{0}; // pixels: a part of the targets, upscaled when it is not all
    glm::mat4 clipFromWorld{1.0f};
    glm::vec3 eye{0.0f};
    uint32_t index = 0;                        // from 1
    uint32_t place = 0;                        // in what frames in flight have one each of
    bool late = false;                         // textures are assigned by the feedback of an earlier frame
    std::vector<uint8_t> inView;               // per object: its bounds meet the view
    std::vector<tsl::ObjectFeedback> feedback; // per object, from the feedback pass
    tsl::Detail detail;                        // how finely lumels are lit, the frame budget's bias among it
    uint32_t lumelBudget = ~0u;                // lumels to light at most
    tsl::Residency& residency;                 // per object, its lit texture
    BoundState bound{};                        // by the functions below
};

// One string names a pass for debug labels and timings.
class PassScope {
public:
    PassScope(Frame& frame, PassName name) : frame_(frame)
    {
        frame_.device.beginLabel(frame_.commands, name.text);
        frame_.timer.begin(frame_.commands, name.text);
    }
    ~PassScope()
    {
        frame_.timer.end(frame_.commands);
        frame_.device.endLabel(frame_.commands);
    }
    PassScope(const PassScope&) = delete;
    PassScope& operator=(const PassScope&) = delete;

private:
    Frame& frame_;
};

// One colour attachment and a depth that is cleared to infinity and not kept; the viewport is the extent.
void beginRendering(vk::CommandBuffer commands, const vk::RenderingAttachmentInfo& color,
                    vk::ImageView depthView, vk::Extent2D extent);

void setViewport(vk::CommandBuffer commands, vk::Extent2D extent);

template<class Push>
void pushConstants(vk::CommandBuffer commands, const gpu::Pipeline& pipeline, const Push& push)
{
    commands.pushConstants<Push>(*pipeline.layout, vk::ShaderStageFlagBits::eAll, 0, push);
}

// What is not bound already.
void bindAll(Frame& frame, vk::PipelineBindPoint point, const gpu::Pipeline& pipeline,
             std::span<const vk::DescriptorSet> sets);

// Set 0 of most pipelines is the frame's view and lights; `sets` follow.
void bindSets(Frame& frame, vk::PipelineBindPoint point, const gpu::Pipeline& pipeline,
              std::initializer_list<vk::DescriptorSet> sets = {});

void setCulling(Frame& frame, vk::CullModeFlags mode, vk::FrontFace front);

// Whether two objects are drawn from the same buffers with the same winding and culling.
bool drawAlike(const GpuObject& a, const GpuObject& b);
// Sets that, and what is not bound already: vertices from `firstVertex` on.
void bindMesh(Frame& frame, const GpuObject& object, uint32_t firstVertex);

// Draws an object's triangles with the bound pipeline, its winding and culling set.
void drawTriangles(Frame& frame, size_t object);

// Over a list, for shaders that include lib/rows.glsl.
inline void dispatchList(vk::CommandBuffer commands, uint32_t invocations)
{
    const glm::uvec2 groups = shared::groupRows(invocations);
    commands.dispatch(groups.x, groups.y, 1);
}

inline uint32_t groupsOf64(uint32_t invocations)
{
    return (invocations + 63) / 64;
}

} // namespace lumel
