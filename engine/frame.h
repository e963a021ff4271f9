// The renderer: one scene, one picture size, frame after frame.
#pragma once
#include "passes/display_pass.h"
#include "passes/draw_pass.h"
#include "passes/light_pass.h"
#include "passes/need_pass.h"
#include "stats.h"

namespace lumel {

class Renderer {
public:
    Renderer(const gpu::Device& device, const scene::Scene& scene,
             const std::vector<scene::BakedMaterial>& materials, const Settings& settings);

    // Renders one frame and waits for it. Throws Interrupted after Ctrl-C.
    FrameStats render(const scene::Camera& camera);

    Image readRadiance() const; // RGB, linear, after render()
    Image readDisplay() const;  // RGB, sRGB-encoded display values in [0, 1]

private:
    void recordFrame(Frame& frame);
    void recordReference(Frame& frame);
    void assignRoom(Frame& frame);
    void begin(Frame& frame);
    void finish(Frame& frame); // submits what is recorded, waits, and adds up the pass times
    void writeView(Frame& frame, glm::vec2 shiftInPixels);

    const gpu::Device& device_;
    Settings settings_;
    Targets targets_;
    GpuScene scene_;
    LitPool pool_;
    NeedPass need_;
    LightPass light_;
    DrawPass draw_;
    DisplayPass display_;
    gpu::Timer timer_;
    gpu::Buffer view_;
    vk::raii::CommandBuffers commands_;
    FrameStats stats_;
    uint64_t frameIndex_ = 0;
};

} // namespace lumel
