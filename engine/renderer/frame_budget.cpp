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
void Renderer::keepToBudget()
{
    if (!budget_)
        return;
    const auto ms = [&](const char* pass) {
        const auto found = stats_.passMs.find(pass);
        return found == stats_.passMs.end() ? 0.0 : found->second;
    };
    budget_->finished(
        {.total = stats_.ms,
         .find = ms("feedback") + ms("plan") + ms("lower"), // coarser tiles are looked at, lit or not
         .light = ms("light"),
         .draw = ms("draw"),
         .display = ms("display"),
         .found = settings_.shading != Shading::tsl || stats_.passMs.contains("feedback"),
         .lumelsLit = stats_.lumelsLit,
         .lumelsPending = stats_.lumelsPending,
         .lumelsAllowed = settings_.lumelBudget,
         .dynamic = dynamicInView_});
    if (budget_->outOfReach() && !budgetMissed_) {
        spdlog::warn(
            "a frame budget of {:g} ms is out of reach here: about {:.0f} ms at half the render scale; "
            "raise --budget-ms or lower --size{}",
            settings_.budgetMs, budget_->floorMs(), settings_.msaa > 1 ? ", or draw with --msaa 1" : "");
        budgetMissed_ = true;
    }
}

} // namespace lumel
