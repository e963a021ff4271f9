// One of the frames in flight: what is its own until it has finished, and what is known of it then.
#pragma once
#include "gpu/timer.h"
#include "renderer/passes/feedback_pass.h"
#include "stats.h"
#include "tsl/budget.h"
#include <chrono>

namespace lumel {

struct InFlight {
    explicit InFlight(const gpu::Device& device) : commands(device.makeCommands()), timer(device) {}

    vk::raii::CommandBuffer commands;
    gpu::Timer timer;
    uint32_t place = 0, frame = 0; // the frame that had this place last
    uint64_t submission = 0;       // its last one
    bool late = false;             // see Frame
    bool planned = false;          // it was not settled
    bool sampled = false;          // its feedback pass ran
    bool unread = false;           // what it leaves is still to be read
    double begunMs = 0.0;          // of the busy clock
    uint32_t divisor = 1;          // of its feedback pass
    tsl::Quality quality;
    size_t dynamicInView = 0;
    FrameStats stats;
    // Once read:
    Feedback feedback; // of a late frame
    size_t tilesMarked = 0, lumelsPending = 0;
};

// Runs while the renderer works or waits, and not while others do.
class BusyClock {
public:
    double ms() const
    {
        return ms_ + (runs_ ? std::chrono::duration<double, std::milli>(Clock::now() - start_).count() : 0.0);
    }
    class Running {
    public:
        explicit Running(BusyClock& clock) : clock_(clock), outer_(clock.runs_)
        {
            if (!outer_)
                clock_.start_ = Clock::now();
            clock_.runs_ = true;
        }
        ~Running()
        {
            if (outer_)
                return;
            clock_.ms_ = clock_.ms();
            clock_.runs_ = false;
        }
        Running(const Running&) = delete;
        Running& operator=(const Running&) = delete;

    private:
        BusyClock& clock_;
        bool outer_;
    };

private:
    using Clock = std::chrono::steady_clock;
    double ms_ = 0.0;
    bool runs_ = false;
    Clock::time_point start_;
};

} // namespace lumel
