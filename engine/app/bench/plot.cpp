#include "plot.h"
#include "core/canvas.h"
#include <array>
#include <fmt/format.h>
#include <functional>
#include <set>

namespace lumel::bench {
namespace {

constexpr int kWidth = 1280, kHeight = 800;
constexpr glm::vec3 kPaper{0.055f, 0.063f, 0.082f}, kPanel{0.082f, 0.094f, 0.122f},
    kGrid{0.16f, 0.18f, 0.22f}, kInk{0.86f, 0.88f, 0.92f}, kFaint{0.55f, 0.59f, 0.66f},
    kBudget{1.0f, 0.35f, 0.35f};
// Told apart also by those who see red and green alike: Okabe and Ito 2008, "Color Universal Design".
constexpr std::array<glm::vec3, 8> kColours{{{0.90f, 0.62f, 0.0f},
                                             {0.34f, 0.71f, 0.91f},
                                             {0.0f, 0.62f, 0.45f},
                                             {0.80f, 0.47f, 0.65f},
                                             {0.94f, 0.89f, 0.26f},
                                             {0.0f, 0.45f, 0.70f},
                                             {0.84f, 0.37f, 0.0f},
                                             {0.75f, 0.75f, 0.75f}}};

glm::vec3 colourOf(size_t run)
{
    return kColours[run % kColours.size()];
}

// A step of 1, 2 or 5 times a power of ten that divides `range` into about `count`.
double niceStep(double range, int count)
{
    const double rough = range / count, power = std::pow(10.0, std::floor(std::log10(rough)));
    for (const double step : {1.0, 2.0, 5.0})
        if (step * power >= rough)
            return step * power;
    return 10.0 * power;
}

struct Panel {
    float left, top, right, bottom;
    double from, to;   // values
    size_t frames = 1; // of the longest run

    float x(size_t frame) const
    {
        return left + (right - left) * (frames > 1 ? float(frame) / float(frames - 1) : 0.5f);
    }
    float y(double value) const
    {
        const double t = std::clamp((value - from) / (to - from), 0.0, 1.0);
        return bottom - float(t) * (bottom - top);
    }
};

void drawGrid(Canvas& canvas, const Panel& panel, const std::string& title)
{
    canvas.box({panel.left, panel.top}, {panel.right, panel.bottom}, kPanel);
    const double step = niceStep(panel.to - panel.from, 4);
    for (double v = std::ceil(panel.from / step) * step; v <= panel.to * (1.0 + 1e-9); v += step) {
        canvas.line({panel.left, panel.y(v)}, {panel.right, panel.y(v)}, kGrid);
        canvas.text({panel.left - 8.0f, panel.y(v) + 4.0f}, fmt::format("{:g}", v), kFaint, 12, Align::right);
    }
    canvas.text({panel.left, panel.top - 8.0f}, title, kInk, 14);
}

void drawFrames(Canvas& canvas, const Panel& panel)
{
    const auto step = size_t(std::max(1.0, niceStep(double(panel.frames), 10)));
    for (size_t frame = 0; frame < panel.frames; frame += step)
        canvas.text({panel.x(frame), panel.bottom + 18.0f}, std::to_string(frame), kFaint, 12, Align::centre);
    canvas.text({panel.right, panel.bottom + 36.0f}, "frame", kFaint, 12, Align::right);
}

using Value = std::function<double(const FrameRecord&)>;

void drawRuns(Canvas& canvas, const Panel& panel, const std::vector<Run>& runs, const Value& value)
{
    for (size_t r = runs.size(); r-- > 0;) { // the first on top
        const auto& frames = runs[r].frames;
        for (size_t i = 0; i + 1 < frames.size(); ++i)
            canvas.line({panel.x(i), panel.y(value(frames[i]))},
                        {panel.x(i + 1), panel.y(value(frames[i + 1]))}, colourOf(r), 1.5f);
        if (frames.size() == 1)
            canvas.box({panel.x(0) - 3, panel.y(value(frames[0])) - 3},
                       {panel.x(0) + 3, panel.y(value(frames[0])) + 3}, colourOf(r));
    }
}

// Lines that one slow frame pushes down would tell nothing: the axis ends a little above the 99th percentile
// of the slowest run; higher values stop at the border.
double topOf(const std::vector<Run>& runs, const Value& value)
{
    double top = 0.0;
    for (const Run& run : runs) {
        std::vector<double> values;
        for (const FrameRecord& frame : run.frames)
            values.push_back(value(frame));
        std::sort(values.begin(), values.end());
        top = std::max(top, values[(values.size() - 1) * 99 / 100]);
    }
    return top > 0.0 ? 1.15 * top : 1.0;
}

float drawLegend(Canvas& canvas, const std::vector<Run>& runs, float top)
{
    constexpr float kColumn = 390.0f, kLine = 19.0f;
    float x = 70.0f, y = top;
    for (size_t r = 0; r < runs.size(); ++r) {
        if (x + kColumn > kWidth) {
            x = 70.0f;
            y += kLine;
        }
        canvas.box({x, y - 6.0f}, {x + 22.0f, y - 2.0f}, colourOf(r));
        canvas.text({x + 30.0f, y}, runs[r].name(), kInk, 12);
        x += kColumn;
    }
    return y + kLine;
}

} // namespace

Image plotRuns(const std::vector<Run>& runs)
{
    Canvas canvas(kWidth, kHeight, kPaper);
    size_t frames = 1;
    std::set<double> budgets;
    for (const Run& run : runs) {
        frames = std::max(frames, run.frames.size());
        if (run.budgetMs() > 0.0)
            budgets.insert(run.budgetMs());
    }
    const float top = drawLegend(canvas, runs, 28.0f) + 22.0f, bottom = float(kHeight) - 48.0f;
    constexpr float kGap = 34.0f;
    const float height = bottom - top - 2.0f * kGap;
    const Value ms = [](const FrameRecord& f) { return f.ms; };
    const Value scale = [](const FrameRecord& f) { return f.renderScale; };
    const Value lumels = [](const FrameRecord& f) { return f.lit / 1000.0; };
    Panel times{70.0f, top, kWidth - 24.0f, top + 0.5f * height, 0.0, topOf(runs, ms), frames};
    if (!budgets.empty())
        times.to = std::max(times.to, 1.2 * *budgets.rbegin());
    Panel scales{times.left, times.bottom + kGap, times.right, times.bottom + kGap + 0.2f * height, 0.4, 1.05,
                 frames};
    Panel lit{times.left, scales.bottom + kGap, times.right, bottom, 0.0, topOf(runs, lumels), frames};

    drawGrid(canvas, times, "frame time, ms");
    drawRuns(canvas, times, runs, ms);
    for (double budget : budgets) {
        canvas.line({times.left, times.y(budget)}, {times.right, times.y(budget)}, kBudget);
        canvas.text({times.right - 6.0f, times.y(budget) - 5.0f}, fmt::format("budget {:g} ms", budget),
                    kBudget, 12, Align::right);
    }
    drawGrid(canvas, scales, "render scale");
    drawRuns(canvas, scales, runs, scale);
    drawGrid(canvas, lit, "lumels lit, thousands");
    drawRuns(canvas, lit, runs, lumels);
    drawFrames(canvas, lit);
    return canvas.image();
}

} // namespace lumel::bench
