// Need: which level of each object's lit texture does this view need? One sample of a block of pixels, in
// each frame at another place of the block.
#pragma once
#include "draw_list.h"
#include <map>

namespace lumel {

// What a frame's samples found.
struct Feedback {
    uint32_t frame = 0; // 0: none
    uint32_t divisor = 1;
    std::vector<shared::ObjectFeedback> objects;
    tsl::Elongations elongations{};
};

class FeedbackPass {
public:
    // Full-size pixels a sample, per axis. Sparse samples are enough where the camera alone moves: what they
    // miss keeps its former light. What has changed loses it.
    static constexpr uint32_t kDense = 4, kSparse = 8;
    // Frames after which the offsets of dense samples have met every pixel.
    static constexpr uint32_t kCycle = kDense * kDense;
    FeedbackPass(const gpu::Device& device, glm::uvec2 size, const SceneState& scene);
    void resize(const gpu::Device& device, glm::uvec2 size);
    void prepare(const Frame& frame); // begins to make all pipelines that the scene can need
    // divisor: kDense, kSparse, or 1 for the first frame of a view that nothing is known of.
    void record(Frame& frame, uint32_t divisor);
    // Whether sparse samples of an earlier frame do for this one too. They serve kLeastFrames, and
    // kMostFrames while no object has moved by more than kMostMotion across the picture. Error and flicker of
    // orbits of half a degree to two degrees a frame are those of samples in every frame.
    bool serveAgain(const Frame& frame, uint32_t divisor);
    static constexpr uint32_t kLeastFrames = 2, kMostFrames = 4;
    static constexpr float kMostMotion = 0.045f; // of the picture's height: 24 pixels of 540
    // Pixels around what the samples stand for that may come into view before others are taken. Without them
    // silhouettes have too little light.
    float margin() const { return divisor_ == kSparse && late_ ? 1.0f : 0.0f; }
    uint32_t frame() const { return frame_; } // that the samples are of, 0: none
    // The same samples once more, at the frame's anisotropy of now.
    void recount(Frame& frame);
    // After the commands that the frame at `place` recorded have finished.
    Feedback read(uint32_t place) const;
    // Fills frame.feedback, by what this frame or an earlier one has found.
    static void apply(const Feedback& feedback, Frame& frame);

    // The samples: set 0, binding 0 of `layout`.
    const gpu::SetLayout& layout() const { return layout_; }
    vk::DescriptorSet set() const { return *set_; }
    glm::uvec2 samples() const { return samples_; }
    uint32_t divisor() const { return divisor_; } // full-size pixels a sample, per axis

private:
    void count(Frame& frame);
    const gpu::Pipeline& maskPipeline(const Frame& frame, bool coloured);
    void drawObjects(Frame& frame, std::span<const size_t> masked);
    glm::uvec2 samples_{0};
    uint32_t divisor_ = kDense;
    uint32_t frame_ = 0;                    // that the samples are of, 0: none
    uint32_t served_ = 0;                   // the latest frame to draw by them
    bool late_ = false;                     // they may serve more frames than their own
    std::vector<glm::mat4> clipFromObject_; // then
    gpu::Image seen_, depth_;
    gpu::SetLayout layout_;
    vk::raii::DescriptorSet set_;
    gpu::Pipeline raster_, count_;
    std::map<uint32_t, gpu::Pipeline> masks_; // by kFeature..., made when first needed
    DrawList list_;
    size_t objectCount_;
    gpu::Counters objects_, total_;
};

} // namespace lumel
