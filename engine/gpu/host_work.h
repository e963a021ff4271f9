// What the CPU does for the device, so that a frame can tell what it cost.
#pragma once
#include <cstdint>

namespace lumel::gpu {

struct HostWork {
    uint64_t waits = 0;            // for the device to finish what was submitted
    uint64_t ringWaits = 0;        // for a frame so old that its part of the rings serves the next one
    uint64_t uploadedBytes = 0;    // written to memory that the device reads
    uint64_t pipelinesCreated = 0; // begun: they compile in the background
};

// Of the calling thread, so that what is loaded beside a frame does not count as the frame's.
inline HostWork& hostWork()
{
    thread_local HostWork work;
    return work;
}

inline HostWork operator-(const HostWork& a, const HostWork& b)
{
    return {a.waits - b.waits, a.ringWaits - b.ringWaits, a.uploadedBytes - b.uploadedBytes,
            a.pipelinesCreated - b.pipelinesCreated};
}

} // namespace lumel::gpu
