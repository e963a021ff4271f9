// Where the time of a bake goes, by step (Options::profile).
#pragma once
#include <array>
#include <memory>

namespace lumel::baker {

enum class Step { input, sums, closedForms, starts, searches, secondLobes, order, output };
inline constexpr std::array kStepNames = {"input lobes",    "sums and lists", "closed forms",
                                          "search starts",  "exact searches", "second lobes",
                                          "order of lobes", "output"};

class Profile {
public:
    Profile();
    ~Profile();
    // Of all threads together. Not while a bake runs.
    std::array<double, kStepNames.size()> seconds() const;

private:
    friend class StepTimer;
    struct Thread;
    struct Threads;
    std::unique_ptr<Threads> threads_;
};

// Counts its lifetime as a step, but for that of other timers inside it on the same thread. Costs a
// comparison where there is no profile; else two readings of the clock: made for batches, not for texels.
class StepTimer {
public:
    StepTimer(Profile* profile, Step step)
    {
        if (profile)
            begin(*profile, step);
    }
    ~StepTimer()
    {
        if (thread_)
            end();
    }
    StepTimer(const StepTimer&) = delete;
    StepTimer& operator=(const StepTimer&) = delete;

private:
    void begin(Profile& profile, Step step);
    void end();
    Profile::Thread* thread_ = nullptr;
    int outer_ = -1; // the step that it interrupts
};

} // namespace lumel::baker
