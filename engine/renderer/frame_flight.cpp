// Frames in flight: which frames are waited for, and what is learnt from those that have finished.
#include "frame.h"
#include <numeric>

namespace lumel {

uint32_t Renderer::places() const
{
    const bool waits = settings_.residency == ResidencyFrom::exact ||
                       settings_.shading == Shading::reference || passesAlone_;
    return waits ? 1 : settings_.framesInFlight;
}

// Hardly any object of the view has a texture of the right size, or any at all.
bool Renderer::isCut(const scene::Camera& camera) const
{
    if (!lastCamera_)
        return true;
    const auto directionOf = [](const scene::Camera& c) { return glm::normalize(c.target - c.eye); };
    constexpr float kFarthest = 1.0f / 8.0f; // of the scene's radius
    const float turned = glm::dot(directionOf(camera), directionOf(*lastCamera_));
    return turned < std::cos(0.5f * lastCamera_->yFov) || // half the view is new
           glm::distance(camera.eye, lastCamera_->eye) > kFarthest * sceneRadius_ ||
           camera.yFov < 0.5f * lastCamera_->yFov;
}

// Whether the next frame goes by what an earlier one has found, and need not wait for what it finds itself.
bool Renderer::isLate(const scene::Camera& camera) const
{
    if (settings_.residency == ResidencyFrom::exact || settings_.shading == Shading::reference ||
        passesAlone_)
        return false;
    return settings_.shading != Shading::tsl || (!first_ && latest_.frame > 0 && detail_ && !isCut(camera));
}

// What a frame leaves that was waited for.
void Renderer::read(InFlight& own)
{
    if (!std::exchange(own.unread, false))
        return;
    const double now = clock_.ms();
    for (const auto& [name, ms] : own.timer.results())
        own.stats.passMs[name] += ms;
    own.stats.ms = now - std::max(own.begunMs, readMs_);
    if (own.late) { // it may have finished while others worked
        double gpuMs = 0.0;
        for (const auto& [name, ms] : own.stats.passMs)
            gpuMs += ms;
        own.stats.ms = std::max(own.stats.ms, gpuMs);
    }
    readMs_ = now;
    if (settings_.shading == Shading::tsl)
        countLumels(own);
    if (own.late && own.sampled) {
        own.feedback = feedback_.read(own.place);
        own.feedback.frame = own.frame;
        own.feedback.divisor = own.divisor;
    }
    keepToBudget(own);
    last_ = own.stats;
    finished_.push_back(own.stats);
    constexpr size_t kMostKept = 16;
    if (finished_.size() > kMostKept)
        finished_.erase(finished_.begin());
}

void Renderer::finish()
{
    const BusyClock::Running runs(clock_);
    std::array<InFlight*, gpu::FrameRing::kMostFrames> order{};
    std::ranges::transform(inFlight_, order.begin(), [](const auto& own) { return own.get(); });
    std::ranges::sort(order, {}, &InFlight::frame);
    for (InFlight* own : order) {
        ring_.wait(own->submission);
        read(*own);
    }
    ring_.waitForAll(); // copies of pictures too
}

void Renderer::learn(InFlight& from)
{
    if (from.feedback.frame > latest_.frame)
        latest_ = std::move(from.feedback);
    from.feedback = {};
    if (from.frame <= knownFrame_)
        return;
    knownFrame_ = from.frame;
    if (!from.planned)
        return;
    tilesMarked_ = from.tilesMarked;
    lumelsPending_ = from.lumelsPending;
}

void Renderer::learnAll()
{
    finish();
    for (const auto& own : inFlight_)
        learn(*own);
}

} // namespace lumel
