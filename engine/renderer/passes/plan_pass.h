// Plan: from the feedback pass's samples, on the GPU, the lists of tiles to light and to derive.
#pragma once
#include "feedback_pass.h"
#include "lit_pool.h"
#include "surface_cache.h"

namespace lumel {

class PlanPass {
public:
    // One indirect dispatch over a list of tiles.
    enum class Surface { found, coloured, cached, cachedAndShadows };
    // Tiles in one block: of one material and vertex buffer, with or without vertex colours; or those whose
    // surface is cached, of one lobe or two, and their shadows or not.
    struct LightJob {
        Surface surface;
        const GpuMaterial* material; // null: of any
        vk::DescriptorSet vertices;  // GpuObject::vertexTexels; none where surfaces are cached
        bool twoLobes;
        int block;
        uint32_t first = 0, capacity = 0; // in the tile list
    };
    struct LowerJobs { // tiles of one block: MIP 1 is job `job`, each coarser MIP's follows, the tail's is
                       // one
        int block;
        uint32_t job = 0;
        std::vector<uint32_t> capacity; // tiles, by MIP from 1
    };

    PlanPass(const gpu::Device& device, const SceneState& scene, const FeedbackPass& feedback);
    // Sorts the frame's objects into jobs and adds their lit textures to the object table.
    void prepare(Frame& frame, const LitPool& pool);
    void record(Frame& frame, const FeedbackPass& feedback);
    // Once all is lit and derived.
    void recordReadback(Frame& frame) const;
    // What was planned and done, after the commands that the frame at `place` recorded have finished.
    const shared::Plan& read(uint32_t place) const { return *readbacks_[place].read<shared::Plan>(); }

    // Lumels that tiles of 8, 16, 32 and 64 lumels a side would hold of what the last plan lit or kept: the
    // price of lighting in larger pieces. `plan`: what it read. Waits for the device.
    std::map<uint32_t, size_t> lumelsByTileSize(const gpu::Device& device, const shared::Plan& plan) const;

    const std::vector<LightJob>& lightJobs() const { return lightJobs_; }
    const std::vector<LowerJobs>& lowerJobs() const { return lowerJobs_; }
    shared::LightPush push(uint32_t job) const;
    vk::Buffer jobBuffer() const { return jobs_.handle(); }
    SurfaceCache& surfaces() { return surfaces_; }
    const SurfaceCache& surfaces() const { return surfaces_; }

private:
    struct ObjectJobs { // that an object's tiles belong to
        uint32_t light = 0, cached = 0, lower = 0;
    };
    // What marks depend on beside the samples: where each object's tiles lie, and how finely it is lit.
    struct Marked {
        uint32_t samples = 0; // the frame that they are of, 0: none
        tsl::Detail detail;
        float reach = 0.0f;
        std::vector<std::tuple<vk::DeviceAddress, uint32_t, float>>
            objects; // tiles, level of MIP 0, finest MIP
        bool operator==(const Marked&) const = default;
    };
    void writeObjects(Frame& frame, const LitPool& pool, const std::vector<ObjectJobs>& jobs);
    bool needsMarks(const Frame& frame, const FeedbackPass& feedback);
    void recordReset(vk::CommandBuffer commands, bool marks);
    uint32_t lightJobOf(const LightJob& job);
    uint32_t lowerJobOf(int block, uint32_t tail);

    gpu::Pipeline mark_, classify_, classifyWaiting_, budget_, select_, bound_, enlist_;
    SurfaceCache surfaces_;
    gpu::Buffer plan_, jobs_, marks_, tiles_;
    bool planKnown_ = false; // what it keeps from frame to frame
    Marked marked_, toMark_; // what the list of marks is of; this frame's
    uint32_t marking_ = 0;   // number of the list
    std::array<gpu::Buffer, gpu::FrameRing::kMostFrames> readbacks_, uploads_;
    std::vector<LightJob> lightJobs_;
    std::vector<LowerJobs> lowerJobs_;
    std::map<std::tuple<Surface, const GpuMaterial*, vk::DescriptorSet, bool, int>, uint32_t> lightJobIndex_;
    std::map<int, uint32_t> lowerJobIndex_; // into lowerJobs_
    uint32_t jobCount_ = 0;
};

} // namespace lumel
