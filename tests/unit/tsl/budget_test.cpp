// The controller against a simulated renderer: costs that it does not know, with noise, steps and spikes.
#include "tsl/budget.h"
#include <algorithm>
#include <functional>
#include <gtest/gtest.h>
#include <random>

using namespace lumel::tsl;

namespace {

// Milliseconds of a machine at full quality. Unlike the model's, drawing has a part that does not scale.
struct Machine {
    double rest = 1.5, find = 2.0, vertices = 1.0, pixels = 9.0, display = 1.0, upscale = 2.5;
    double lumel = 6e-5;
    double marked = 6e5;  // lumels that the view needs
    double turning = 0.1; // share of them that motion makes due each frame
    double wait = 0.0;    // added to the frame, in no pass
    double load = 1.0;    // multiplies pixels and lumels
    size_t dynamic = 0;   // objects that are all of the view; shaded per pixel they need no lumels,
    double shading = 1.0; // and multiply the pixels by this
};

struct History {
    std::vector<double> ms;
    std::vector<Quality> qualities;
    std::vector<size_t> pending;

    double percentile(size_t from, size_t to, double p) const
    {
        std::vector<double> sorted(ms.begin() + long(from), ms.begin() + long(to));
        std::sort(sorted.begin(), sorted.end());
        return sorted[size_t(p * double(sorted.size() - 1))];
    }
    int turns(size_t from = 0) const // how often the render scale changes direction
    {
        int count = 0;
        float last = 0.0f;
        for (size_t i = from + 1; i < qualities.size(); ++i) {
            const float step = qualities[i].renderScale - qualities[i - 1].renderScale;
            count += step * last < 0.0f ? 1 : 0;
            last = step != 0.0f ? step : last;
        }
        return count;
    }
};

class Simulation {
public:
    Simulation(double budget, double noise, unsigned seed = 1)
        : controller(budget), noise_(noise), random_(seed)
    {
    }

    // at: changes the machine before frame i.
    History run(size_t frames, const std::function<void(size_t, Machine&)>& at = {})
    {
        History result;
        for (size_t i = 0; i < frames; ++i) {
            machine.wait = 0.0;
            if (at)
                at(i, machine);
            result.qualities.push_back(controller.quality());
            const FrameCost cost = render(controller.quality());
            controller.finished(cost);
            result.ms.push_back(cost.total);
            result.pending.push_back(cost.lumelsPending);
        }
        return result;
    }

    Machine machine;
    BudgetController controller;

private:
    double noisy(double ms)
    {
        return ms * std::uniform_real_distribution(1.0 - noise_, 1.0 + noise_)(random_);
    }

    FrameCost render(const Quality& q)
    {
        const double share = double(q.renderScale) * double(q.renderScale);
        const double marked = machine.marked * share * std::pow(4.0, -double(q.levelBias));
        // A finer view makes what is new due.
        due_ = first_ ? marked
                      : std::min(marked, due_ + std::max(0.0, marked - marked_) + machine.turning * marked);
        marked_ = marked;
        if (q.dynamicPerPixel)
            due_ = 0.0;
        const double shading = q.dynamicPerPixel ? machine.shading : 1.0;
        const double lit = std::min(due_, double(q.lumels));
        due_ -= lit;
        // Passes vary one by one, and the frame as a whole.
        const double whole = noisy(1.0);
        FrameCost cost;
        cost.find = whole * noisy(machine.find * share);
        cost.light = whole * noisy(machine.load * machine.lumel * lit);
        cost.draw = whole * noisy(machine.vertices + machine.load * machine.pixels * shading * share);
        cost.display = whole * noisy(q.renderScale < 1.0f ? machine.upscale : machine.display);
        cost.total = cost.find + cost.light + cost.draw + cost.display + whole * machine.rest + machine.wait;
        if (first_)
            cost.total += 300.0; // pipelines are compiled at their first use
        first_ = false;
        cost.lumelsLit = size_t(lit);
        cost.lumelsPending = size_t(due_);
        cost.dynamic = machine.dynamic;
        return cost;
    }

    double noise_;
    std::mt19937 random_;
    double due_ = 0.0, marked_ = 0.0;
    bool first_ = true;
};

constexpr float kFull = 1.0f;

} // namespace

TEST(Budget, TheFirstFrameDoesNotLightEverything)
{
    const BudgetController controller(33.0);
    EXPECT_LT(controller.quality().lumels, 500000u);
    EXPECT_GT(controller.quality().lumels, 50000u);
    EXPECT_EQ(controller.quality().renderScale, kFull);
    EXPECT_EQ(controller.quality().levelBias, 0.0f);
}

TEST(Budget, AnEasyBudgetKeepsFullQualityAfterASlowStart)
{
    Simulation s(100.0, 0.1);
    const History run = s.run(200);
    for (const Quality& quality : run.qualities)
        EXPECT_EQ(quality.renderScale, kFull);
    EXPECT_EQ(run.qualities.back().levelBias, 0.0f);
    EXPECT_EQ(run.pending.back(), 0u);
    EXPECT_FALSE(s.controller.outOfReach());
}

TEST(Budget, NoiseOf20PercentIsHeldWithoutOscillation)
{
    for (const double budget : {12.0, 16.0, 24.0, 33.0, 50.0})
        for (unsigned seed = 1; seed <= 20; ++seed) {
            Simulation s(budget, 0.2, seed);
            const History run = s.run(600);
            EXPECT_LE(run.percentile(30, 600, 0.95), 1.1 * budget) << budget << " ms, seed " << seed;
            EXPECT_GE(run.percentile(30, 600, 0.5), 0.5 * std::min(budget, 20.0)) << "the budget is used";
            EXPECT_LE(run.turns(), 2) << budget << " ms, seed " << seed;
        }
}

TEST(Budget, AStepInLoadIsTakenIn15FramesAndQualityReturns)
{
    for (unsigned seed = 1; seed <= 20; ++seed) {
        Simulation s(24.0, 0.1, seed);
        const History run =
            s.run(700, [](size_t i, Machine& m) { m.load = i >= 200 && i < 400 ? 3.0 : 1.0; });
        EXPECT_LE(run.percentile(215, 400, 0.95), 1.1 * 24.0) << "seed " << seed;
        EXPECT_LT(run.qualities[399].renderScale, kFull);
        EXPECT_EQ(run.qualities[199].renderScale, kFull);
        EXPECT_EQ(run.qualities[520].renderScale, kFull) << "seed " << seed;
        EXPECT_EQ(run.qualities.back().levelBias, run.qualities[199].levelBias) << "seed " << seed;
        EXPECT_LE(run.turns(), 2) << "seed " << seed;
    }
}

TEST(Budget, ASpikeOfOneFrameChangesNothing)
{
    Simulation calm(24.0, 0.0), spiked(24.0, 0.0);
    const History without = calm.run(200);
    const History with = spiked.run(200, [](size_t i, Machine& m) {
        if (i == 100)
            m.wait = 100.0;
    });
    for (size_t i = 0; i < 200; ++i) {
        EXPECT_EQ(with.qualities[i].renderScale, without.qualities[i].renderScale) << "frame " << i;
        EXPECT_EQ(with.qualities[i].levelBias, without.qualities[i].levelBias) << "frame " << i;
        EXPECT_NEAR(with.qualities[i].lumels, without.qualities[i].lumels, 0.05 * without.qualities[i].lumels)
            << "frame " << i;
    }
}

TEST(Budget, ASlowRampIsFollowedDownAndUp)
{
    Simulation s(24.0, 0.1);
    const History run = s.run(800, [](size_t i, Machine& m) {
        m.load = 1.0 + 2.5 * (i < 300 ? double(i) / 300.0 : std::max(0.0, double(600 - double(i)) / 300.0));
    });
    EXPECT_LE(run.percentile(30, 800, 0.95), 1.1 * 24.0);
    EXPECT_LT(run.qualities[300].renderScale, 0.9f);
    EXPECT_EQ(run.qualities.back().renderScale, kFull);
    EXPECT_LE(run.turns(), 2);
}

TEST(Budget, LumelsComeFirstThenLevelsThenTheRenderScale)
{
    // Only lumels are expensive: fewer are lit, then coarser ones, and every pixel stays.
    Simulation dearLumels(24.0, 0.1);
    dearLumels.machine.lumel = 2e-3;
    dearLumels.machine.turning = 1.0;
    const History run = dearLumels.run(300);
    EXPECT_LT(run.qualities.back().lumels, 10000u);
    const auto coarser = std::find_if(run.qualities.begin(), run.qualities.end(),
                                      [](const Quality& quality) { return quality.levelBias > 0.0f; });
    ASSERT_NE(coarser, run.qualities.end());
    EXPECT_LT(coarser->lumels, run.qualities.front().lumels);
    EXPECT_GT(run.qualities.back().levelBias, 0.3f);
    EXPECT_EQ(run.qualities.back().renderScale, kFull);
    // Only pixels are expensive: lumels are cut to their least share before the scale falls.
    Simulation dearPixels(24.0, 0.0);
    dearPixels.machine.pixels = 30.0;
    const History pixels = dearPixels.run(300);
    EXPECT_LT(pixels.qualities.back().renderScale, kFull);
    EXPECT_GE(pixels.qualities.back().lumels * dearPixels.machine.lumel, 0.045 * 24.0);
}

TEST(Budget, ABudgetOutOfReachSettlesAtTheFloor)
{
    Simulation s(4.0, 0.2);
    const History run = s.run(300);
    EXPECT_TRUE(s.controller.outOfReach());
    EXPECT_GT(s.controller.floorMs(), 4.0);
    EXPECT_NEAR(s.controller.floorMs(), run.percentile(100, 300, 0.5), 0.35 * s.controller.floorMs());
    for (size_t i = 60; i < 300; ++i)
        ASSERT_EQ(run.qualities[i].renderScale, kLeastRenderScale);
    EXPECT_GE(run.qualities.back().lumels, 1024u); // light still follows
    s.machine = {.rest = 0.1, .find = 0.1, .vertices = 0.1, .pixels = 0.5, .display = 0.1, .upscale = 0.2};
    s.run(100);
    EXPECT_FALSE(s.controller.outOfReach());
}

TEST(Budget, LightThatLumelsCannotFollowIsShadedPerPixel)
{
    Simulation s(30.0, 0.2);
    s.machine.turning = 1.0; // every lumel is due again each frame: 240 ms
    s.machine.marked = 4e6;
    s.machine.dynamic = 5;
    s.machine.shading = 2.0;
    const History run = s.run(300, [](size_t i, Machine& machine) {
        if (i == 200) {
            machine.turning = 0.05;
            machine.dynamic = 0;
        }
    });
    EXPECT_TRUE(run.qualities[100].dynamicPerPixel);
    EXPECT_EQ(run.pending[190], 0u);
    EXPECT_LT(run.percentile(100, 200, 0.95), 1.1 * 30.0);
    EXPECT_FALSE(run.qualities.back().dynamicPerPixel);
    // Lumels of a view that only turns may wait.
    Simulation turning(30.0, 0.2);
    turning.machine.turning = 1.0;
    turning.machine.marked = 4e6;
    EXPECT_FALSE(turning.run(300).qualities.back().dynamicPerPixel);
}

TEST(Budget, ShadingPerPixelThatTakesTooLongIsGivenUp)
{
    Simulation s(30.0, 0.1);
    s.machine.turning = 1.0;
    s.machine.marked = 4e6;
    s.machine.dynamic = 5;
    s.machine.shading = 20.0; // 45 ms at half the scale
    const History run = s.run(500);
    int frames = 0, changes = 0;
    for (size_t i = 1; i < run.qualities.size(); ++i) {
        frames += run.qualities[i].dynamicPerPixel ? 1 : 0;
        changes += run.qualities[i].dynamicPerPixel != run.qualities[i - 1].dynamicPerPixel ? 1 : 0;
    }
    EXPECT_GT(frames, 0);
    EXPECT_LT(frames, 80);
    EXPECT_LE(changes, 4); // tried again once
    EXPECT_LT(run.percentile(200, 500, 0.95), 1.1 * 30.0);
}

TEST(Budget, AStillViewEndsAtFullQuality)
{
    Simulation s(20.0, 0.1);
    s.machine.turning = 0.0;
    s.machine.marked = 1.5e7; // hundreds of frames' worth
    const History run = s.run(1200);
    EXPECT_GT(std::max_element(run.qualities.begin(), run.qualities.end(),
                               [](const Quality& a, const Quality& b) { return a.levelBias < b.levelBias; })
                  ->levelBias,
              0.5f);
    EXPECT_EQ(run.qualities.back().levelBias, 0.0f);
    EXPECT_EQ(run.qualities.back().renderScale, kFull);
    EXPECT_EQ(run.pending.back(), 0u);
}

TEST(Budget, FramesThatFoundNothingToDoDoNotHideWhatLookingCosts)
{
    BudgetController controller(20.0);
    const auto frame = [&](bool found) {
        const double pixels = double(controller.quality().renderScale * controller.quality().renderScale);
        FrameCost cost{
            .find = found ? 8.0 * pixels : 0.0, .draw = 15.0 * pixels, .display = 1.0, .found = found};
        cost.total = cost.find + cost.draw + cost.display + 1.0;
        controller.finished(cost);
    };
    for (int i = 0; i < 40; ++i)
        frame(true);
    const float scale = controller.quality().renderScale;
    EXPECT_LT(scale, kFull);
    for (int i = 0; i < 200; ++i)
        frame(false);
    EXPECT_EQ(controller.quality().renderScale, scale);
}
