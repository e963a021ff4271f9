// Light: every lumel of each visible object, at the object's maximum MIP level, by compute over its tiles.
// Lower levels: the coarser MIPs from the lit ones.
#pragma once
#include "lit_pool.h"

namespace lumel {

class LightPass {
public:
    LightPass(const gpu::Device& device, const GpuScene& scene, const LitPool& pool);
    // Lists the tiles of frame.room; returns how many are to be lit, the coarser MIPs' not counted.
    size_t listTiles(Frame& frame);
    void recordLight(Frame& frame, LitPool& pool);
    void recordLower(Frame& frame, LitPool& pool);

private:
    struct Job { // an object's tiles of one MIP of its texture
        uint32_t object, mip, firstTile, tileCount;
    };
    gpu::Pipeline light_, lower_;
    gpu::Buffer tiles_;
    std::vector<Job> jobs_; // by MIP
};

} // namespace lumel
