// Frames in flight: submissions of one renderer in order, and which of them have finished. What the CPU
// writes or reads in each frame lies in rings, of which a frame has one place; a place is free again once the
// frame that had it has finished.
#pragma once
#include "device.h"

namespace lumel::gpu {

class FrameRing {
public:
    static constexpr uint32_t kMostFrames = 3;
    explicit FrameRing(const Device& device);
    ~FrameRing();
    FrameRing(const FrameRing&) = delete;
    FrameRing& operator=(const FrameRing&) = delete;

    // The submission's number, from 1. The fence is another's, who waits for it apart from the ring.
    uint64_t submit(vk::CommandBuffer commands, vk::Fence fence = {});
    uint64_t submitted() const { return submitted_; } // the last one's number
    uint64_t finished() const { return finished_; }   // as far as was waited for
    void wait(uint64_t submission);                   // the frame cannot go on without it: counted as a wait
    void waitForPlace(uint64_t submission);           // counted as a ring's wait
    // Before anything is replaced that frames in flight may use.
    void waitForAll() { wait(submitted_); }

private:
    bool waitFor(uint64_t submission); // false: it was known to have finished
    const Device& device_;
    vk::raii::Semaphore timeline_;
    uint64_t submitted_ = 0, finished_ = 0;
};

} // namespace lumel::gpu
