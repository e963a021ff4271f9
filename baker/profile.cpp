#include "profile.h"
#include <chrono>
#include <tbb/enumerable_thread_specific.h>

namespace lumel::baker {

using Clock = std::chrono::steady_clock;

struct Profile::Thread {
    std::array<double, kStepNames.size()> seconds{};
    int step = -1; // that runs
    Clock::time_point since;

    // Charges the time so far to the step that ran. Returns it.
    int change(int to)
    {
        const Clock::time_point now = Clock::now();
        const int before = step;
        if (before >= 0)
            seconds[size_t(before)] += std::chrono::duration<double>(now - since).count();
        since = now;
        step = to;
        return before;
    }
};

struct Profile::Threads {
    tbb::enumerable_thread_specific<Thread> all;
};

Profile::Profile() : threads_(std::make_unique<Threads>()) {}
Profile::~Profile() = default;

std::array<double, kStepNames.size()> Profile::seconds() const
{
    std::array<double, kStepNames.size()> sum{};
    for (const Thread& thread : threads_->all)
        for (size_t i = 0; i < sum.size(); ++i)
            sum[i] += thread.seconds[i];
    return sum;
}

void StepTimer::begin(Profile& profile, Step step)
{
    thread_ = &profile.threads_->all.local();
    outer_ = thread_->change(int(step));
}

void StepTimer::end()
{
    thread_->change(outer_);
}

} // namespace lumel::baker
