// The frame budget: what changes too often to be lit in texture space, and what the frame cost.
#include "frame.h"
#include <spdlog/spdlog.h>

namespace lumel {

void Renderer::noteDynamic(const Frame& frame)
{
    dynamicInView_ = 0;
    for (size_t i = 0; i < frame.inView.size(); ++i)
        if (frame.inView[i]) {
            dynamicObjects_.note(i, scene_.changedSince(i, frame.index));
            dynamicInView_ += dynamicObjects_.is(i) ? 1 : 0;
        }
}

// Tells the controller what the frame cost, and the user when no quality is low enough.
void Renderer::keepToBudget(const InFlight& own)
{
    if (!budget_)
        return;
    const auto ms = [&](const char* pass) {
        const auto found = own.stats.passMs.find(pass);
        return found == own.stats.passMs.end() ? 0.0 : found->second;
    };
    budget_->finished(
        {.total = own.stats.ms,
         .find = ms("feedback") + ms("plan") + ms("lower"), // coarser tiles are looked at, lit or not
         .light = ms("light"),
         .draw = ms("draw"),
         .display = ms("display"),
         .found = settings_.shading != Shading::tsl || own.stats.passMs.contains("feedback"),
         .lumelsLit = own.stats.lumelsLit,
         .lumelsPending = own.stats.lumelsPending,
         .lumelsAllowed = settings_.lumelBudget,
         .dynamic = own.dynamicInView},
        own.quality);
    if (budget_->outOfReach() && !budgetMissed_) {
        spdlog::warn(
            "a frame budget of {:g} ms is out of reach here: about {:.0f} ms at the least render scale; "
            "raise --budget-ms or lower --size{}",
            settings_.budgetMs, budget_->floorMs(), settings_.msaa > 1 ? ", or draw with --msaa 1" : "");
        budgetMissed_ = true;
    }
}

} // namespace lumel
