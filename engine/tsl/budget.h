// Budget: what the next frame may do so that it ends in time. Three knobs, in this order: lumels lit, levels
// that all lumels are coarser, render scale; and a switch for light that lumels cannot follow.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace lumel::tsl {

// The knobs of one frame.
struct Quality {
    uint32_t lumels = ~0u;        // to light at most
    float levelBias = 0.0f;       // levels, 0 to kMostLevelBias
    float renderScale = 1.0f;     // of the picture's width and height, kLeastRenderScale to 1
    bool dynamicPerPixel = false; // objects whose light changes frame after frame leave texture space

    bool samePicture(const Quality& other) const // once everything is lit
    {
        return levelBias == other.levelBias && renderScale == other.renderScale &&
               dynamicPerPixel == other.dynamicPerPixel;
    }
};
inline constexpr float kMostLevelBias = 2.0f;
inline constexpr float kLeastRenderScale = 0.4375f; // upscale.comp takes 0.34 to 1
inline constexpr float kRenderScaleStep = 1.0f / 32.0f;

// What a finished frame cost, in milliseconds, and what it did.
struct FrameCost {
    double total = 0.0; // wall time
    double find = 0.0;  // what is to be lit? Scales with the pixels
    double light = 0.0; // scales with the lumels lit
    double draw = 0.0;  // scales with the pixels
    double display = 0.0;
    bool found = true; // false: nothing had changed, so that nothing was looked for
    size_t lumelsLit = 0, lumelsPending = 0;
    uint32_t lumelsAllowed = ~0u; // by other limits
    size_t dynamic = 0;           // objects in view whose light changes frame after frame
};

// The median of the last few values: blind to a spike of one or two frames, such as a pipeline's first use.
class Estimate {
public:
    explicit Estimate(double prior = 0.0) { values_.fill(prior); }
    void add(double value);
    double value() const;

private:
    std::array<double, 5> values_;
    size_t next_ = 0;
};

// total = rest + (find + draw) scale^2 + display + light a lumel. Nothing is known of the machine at first:
// of what pixels cost nothing is assumed, of lumels much.
class CostModel {
public:
    void learn(const FrameCost& cost, const Quality& quality);
    // Of everything but lighting lumels.
    double withoutLumels(float renderScale) const;
    double lumel() const { return lumel_.value(); }
    // Measured time over the model's, as it is exceeded in about 6 % of the recent frames; 1 to 1.4.
    double excess() const;

private:
    Estimate rest_, find_, draw_, display_, upscale_;
    Estimate lumel_{1e-4};
    std::vector<double> ratios_ = std::vector<double>(64, 1.1);
    size_t next_ = 0;
};

class BudgetController {
public:
    explicit BudgetController(double budgetMs); // > 0

    const Quality& quality() const { return quality_; } // for the next frame
    // `cost`: of a frame rendered at `quality`, which quality() gave, maybe a few frames ago.
    void finished(const FrameCost& cost, const Quality& quality);
    void finished(const FrameCost& cost) { finished(cost, quality_); }

    // The budget has been out of reach for a while with every knob at its end.
    bool outOfReach() const { return framesAtFloor_ >= 3 * kPatience; } // what waits has been lit by then
    double floorMs() const;                                             // what a frame costs then

private:
    static constexpr int kPatience = 20; // frames
    static constexpr int kMostPatience = 240;
    float scaleFor(double ms) const;
    void moveScale(double target);
    void moveLevelBias(const FrameCost& cost, const Quality& quality);
    void moveDynamic(const FrameCost& cost, double target);
    void allotLumels(double target);

    double budget_;
    CostModel model_;
    Quality quality_;
    double latency_ = 0.0; // frames until what waits is lit, smoothed
    int framesAtFloor_ = 0;
    int framesOver_ = 0, framesUnder_ = 0;
    int framesBehind_ = 0, framesCalm_ = 0, framesDear_ = 0; // of lights that lumels cannot follow
    int framesToRetry_ = 150;
    int framesSinceRise_ = kMostPatience;
    int patience_ = kPatience; // frames that a greater scale must be affordable before it is taken
};

} // namespace lumel::tsl
