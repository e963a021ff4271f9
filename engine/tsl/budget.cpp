#include "budget.h"
#include <algorithm>
#include <cmath>

namespace lumel::tsl {
namespace {

// Of the budget, for lumels. However expensive the pixels are, lumels get the least share, so that light
// follows what moves. Pixels that leave them less make the render scale fall to where they get the second
// share, and it rises when they would still get the third: in between, lumels give and take.
constexpr double kLeastShare = 0.05, kShareAfterFall = 0.14, kShareAfterRise = 0.22;
// Of what the fewest pixels take beyond the budget: it is missed anyway, and light that waits would show
// more.
constexpr double kShareOfExcess = 0.3;
// Below this many lumels the time says nothing about one: dispatches dominate.
constexpr size_t kTellingLumels = 1024;
constexpr double kLeastExcess = 1.0, kMostExcess = 1.4;

// Frames that lumels wait: beyond the upper bound everything gets coarser, below the lower one finer. A level
// changes the number of lumels by 4, so the two are further apart than that.
constexpr double kLongWait = 32.0, kShortWait = 4.0;
constexpr float kCoarserStep = 1.0f / 16.0f, kFinerStep = 1.0f / 32.0f; // levels per frame: no visible jump

// What shading pixels makes of the least that a frame costs, before it is known.
constexpr double kPerPixelGuess = 1.5;
constexpr int kMostFramesToRetry = 1200;

constexpr int kFramesToFall = 4;
constexpr float kMostRise = 1.0f / 16.0f;
constexpr int kFramesBetweenRises = 4;

} // namespace

void Estimate::add(double value)
{
    values_[next_] = value;
    next_ = (next_ + 1) % values_.size();
}

double Estimate::value() const
{
    std::array<double, 5> sorted = values_;
    std::nth_element(sorted.begin(), sorted.begin() + 2, sorted.end());
    return sorted[2];
}

void CostModel::learn(const FrameCost& cost, const Quality& quality)
{
    const double pixels = double(quality.renderScale) * double(quality.renderScale);
    draw_.add(cost.draw / pixels);
    (quality.renderScale < 1.0f ? upscale_ : display_).add(cost.display);
    if (!cost.found)
        return; // cheaper than the frame that must fit
    find_.add(cost.find / pixels);
    rest_.add(std::max(0.0, cost.total - cost.find - cost.light - cost.draw - cost.display));
    if (cost.lumelsLit >= kTellingLumels)
        lumel_.add(cost.light / double(cost.lumelsLit));
    const double modelled = withoutLumels(quality.renderScale) + lumel() * double(cost.lumelsLit);
    if (modelled > 0.0)
        ratios_[next_++ % ratios_.size()] = std::clamp(cost.total / modelled, kLeastExcess, kMostExcess);
}

double CostModel::withoutLumels(float renderScale) const
{
    const double pixels = double(renderScale) * double(renderScale);
    // Before the first scaled frame, upscaling is taken to cost as much as what it replaces.
    const double upscaling = std::max(upscale_.value(), display_.value());
    return rest_.value() + pixels * (find_.value() + draw_.value()) +
           (renderScale < 1.0f ? upscaling : display_.value());
}

double CostModel::excess() const
{
    std::vector<double> sorted = ratios_;
    std::nth_element(sorted.begin(), sorted.begin() + 4, sorted.end(), std::greater<>());
    return sorted[4]; // the fifth of 64: a few spikes do not count
}

BudgetController::BudgetController(double budgetMs) : budget_(budgetMs)
{
    allotLumels(budget_ / model_.excess());
}

void BudgetController::allotLumels(double target)
{
    const double left = target - model_.withoutLumels(quality_.renderScale);
    double least = kLeastShare * budget_;
    if (quality_.renderScale == kLeastRenderScale)
        least += kShareOfExcess * std::max(-left, 0.0);
    quality_.lumels = uint32_t(
        std::clamp(std::max(left, least) / std::max(model_.lumel(), 1e-9), double(kTellingLumels), 4e9));
}

// The greatest scale at which all but lumels cost at most `ms`.
float BudgetController::scaleFor(double ms) const
{
    for (float scale = 1.0f; scale > kLeastRenderScale; scale -= kRenderScaleStep)
        if (model_.withoutLumels(scale) <= ms)
            return scale;
    return kLeastRenderScale;
}

void BudgetController::moveScale(double target)
{
    float& scale = quality_.renderScale;
    framesSinceRise_ = std::min(framesSinceRise_ + 1, kMostPatience);
    if (framesSinceRise_ == kMostPatience)
        patience_ = kPatience;
    framesOver_ = model_.withoutLumels(scale) > target - kLeastShare * budget_ ? framesOver_ + 1 : 0;
    const float affordable = scaleFor(target - kShareAfterRise * budget_);
    framesUnder_ = affordable > scale ? framesUnder_ + 1 : 0;
    if (framesOver_ >= kFramesToFall && scale > kLeastRenderScale) {
        // A rise that had to be taken back is tried again later each time.
        if (framesSinceRise_ < 2 * patience_)
            patience_ = std::min(2 * patience_, kMostPatience);
        scale = std::min(scale, scaleFor(target - kShareAfterFall * budget_));
        framesOver_ = 0;
    } else if (framesUnder_ >= patience_) {
        scale = std::min(affordable, scale + kMostRise);
        framesUnder_ = patience_ - kFramesBetweenRises;
        framesSinceRise_ = 0;
    }
}

void BudgetController::moveLevelBias(const FrameCost& cost, const Quality& quality)
{
    const double wait = double(cost.lumelsPending) / double(std::min(quality.lumels, cost.lumelsAllowed));
    latency_ += 0.2 * (std::min(wait, 4.0 * kLongWait) - latency_);
    float& bias = quality_.levelBias;
    if (latency_ > kLongWait)
        bias = std::min(bias + kCoarserStep, kMostLevelBias);
    else if (latency_ < kShortWait)
        bias = std::max(bias - kFinerStep, 0.0f);
}

// Lighting that waits while its lights move on is stale, which is worse than fewer pixels: shading
// pixels costs more than drawing lumels, but none of it waits.
void BudgetController::moveDynamic(const FrameCost& cost, double target)
{
    const bool behind = cost.dynamic > 0 && latency_ > kShortWait && kPerPixelGuess * floorMs() < target;
    framesBehind_ = behind ? framesBehind_ + 1 : std::min(framesBehind_, 0);
    framesCalm_ = cost.dynamic > 0 ? 0 : framesCalm_ + 1;
    const bool dear =
        quality_.dynamicPerPixel && quality_.renderScale == kLeastRenderScale && floorMs() > target;
    framesDear_ = dear ? framesDear_ + 1 : 0;
    if (framesDear_ >= kFramesToFall) {
        quality_.dynamicPerPixel = false; // it costs more than there is
        framesBehind_ = -framesToRetry_;
        framesToRetry_ = std::min(2 * framesToRetry_, kMostFramesToRetry);
    } else if (framesBehind_ >= kPatience) {
        quality_.dynamicPerPixel = true;
    } else if (framesCalm_ >= kPatience) {
        quality_.dynamicPerPixel = false;
    }
}

void BudgetController::finished(const FrameCost& cost, const Quality& quality)
{
    model_.learn(cost, quality);
    const double target = budget_ / model_.excess();
    moveLevelBias(cost, quality);
    moveDynamic(cost, target);
    moveScale(target);
    allotLumels(target);
    const bool atFloor = quality_.renderScale == kLeastRenderScale && floorMs() > budget_;
    framesAtFloor_ = atFloor ? framesAtFloor_ + 1 : 0;
}

double BudgetController::floorMs() const
{
    return model_.withoutLumels(kLeastRenderScale) + kLeastShare * budget_;
}

} // namespace lumel::tsl
