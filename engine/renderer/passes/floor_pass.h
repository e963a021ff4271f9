// Floors: the least that each pass could take on this device, for the same scene, view and size. Passes of a
// few lines that do a constant amount of work for each lumel or pixel and nothing else. Only measurements run
// them (`bench --floors`); they change no picture.
#pragma once
#include "lit_pool.h"
#include <map>

namespace lumel {

// Of one frame.
struct FloorStats {
    std::map<std::string, double> nanoseconds; // by kFloorNames, for each lumel lit, lumel derived or pixel
    size_t pixels = 0;                         // that anything covers
};

class FloorPass {
public:
    FloorPass(const gpu::Device& device, const SceneState& scene, const Settings& settings);

    Targets& targets() { return targets_; } // to be the frame's
    // Of the passes that the frame's shading has. `lumelsLit` and `lumelsDerived`: as many as the frame lit
    // and derived, up to what the texture holds; 0 leaves the floor out.
    void record(Frame& frame, const LitPool& pool, size_t lumelsLit, size_t lumelsDerived);
    // After the recorded commands have finished.
    FloorStats read(const gpu::Device& device, const gpu::Timer& timer) const;

private:
    void uploadSurfaces(const gpu::Device& device);
    void recordLight(Frame& frame);
    void recordLower(Frame& frame);
    void recordFeedback(Frame& frame);
    void recordDraw(Frame& frame, const LitPool& pool, const gpu::Pipeline& pipeline);
    void recordForward(Frame& frame);

    Targets targets_;
    gpu::Image seen_, seenDepth_; // of feedback
    gpu::Image surfaces_;
    gpu::Image lit_; // layer 1: half the size
    vk::raii::Sampler linear_, nearest_;
    gpu::SetLayout layout_;
    vk::raii::DescriptorSet set_;
    gpu::Pipeline light_, lower_, feedback_, bilinear_, bicubic_, twoLevels_, forward_;
    // Of what is recorded.
    uint32_t lumelsLit_ = 0, lumelsDerived_ = 0;
    glm::uvec2 drawn_{0}; // pixels
};

} // namespace lumel
