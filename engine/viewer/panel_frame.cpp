// What a frame costs: the times of the last frames, the passes of the latest, lumels and memory.
#include "core/pass_names.h"
#include "panels.h"
#include "setting_widgets.h"
#include <algorithm>
#include <fmt/format.h>

namespace lumel::ui {
namespace {

// Of kPassNames.
constexpr std::array<ImU32, kPassNames.size()> kPassColours{
    IM_COL32(200, 96, 128, 255),  IM_COL32(150, 110, 190, 255), IM_COL32(94, 160, 220, 255),
    IM_COL32(120, 132, 220, 255), IM_COL32(236, 168, 72, 255),  IM_COL32(206, 120, 76, 255),
    IM_COL32(104, 190, 130, 255), IM_COL32(170, 174, 184, 255)};

double passMs(const FrameSample& sample, const char* pass)
{
    const auto found = sample.passMs.find(pass);
    return found == sample.passMs.end() ? 0.0 : found->second;
}

float rowHeight()
{
    return 1.3f * ImGui::GetFontSize();
}

float graphHeight()
{
    return 4.2f * ImGui::GetFontSize();
}

// A share of a row as a bar.
void bar(float share, ImU32 colour, ImVec2 at, ImVec2 size)
{
    ImDrawList* list = ImGui::GetWindowDrawList();
    list->AddRectFilled(at, {at.x + size.x, at.y + size.y}, IM_COL32(37, 40, 46, 255), 2.0f);
    const float width = size.x * std::clamp(share, 0.0f, 1.0f);
    if (width >= 1.0f)
        list->AddRectFilled(at, {at.x + width, at.y + size.y}, colour, 2.0f);
}

float medianOf(std::vector<float> values)
{
    const auto middle = values.begin() + long(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

struct FrameRate {
    float ms = 0.0f, perSecond = 0.0f; // medians of the second before the newest frame; 0: unknown
};

FrameRate frameRate(const std::deque<FrameSample>& history)
{
    std::vector<float> times, intervals;
    for (auto sample = history.rbegin(); sample != history.rend(); ++sample) {
        if (sample->at < history.back().at - 1.0)
            break;
        times.push_back(sample->ms);
        if (sample != history.rbegin())
            intervals.push_back(float(std::prev(sample)->at - sample->at));
    }
    FrameRate rate;
    if (!times.empty())
        rate.ms = medianOf(times);
    if (!intervals.empty())
        rate.perSecond = 1.0f / std::max(medianOf(intervals), 1e-4f);
    return rate;
}

// Milliseconds that the graph spans: twice the median, rounded up so that it rarely changes. Single long
// frames, such as a scene's first, are clipped.
float spanOf(const ViewReport& report)
{
    std::vector<float> times;
    for (const FrameSample& sample : report.history)
        times.push_back(sample.ms);
    if (times.empty())
        return 20.0f;
    const float middle = medianOf(times);
    float span = 20.0f;
    while (span < 2.0f * middle)
        span *= 2.0f;
    return span;
}

void drawGraph(const ViewReport& report, double budgetMs)
{
    constexpr int kBars = 120;
    ImDrawList* list = ImGui::GetWindowDrawList();
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const ImVec2 size{ImGui::GetContentRegionAvail().x, graphHeight()};
    ImGui::Dummy(size);
    list->AddRectFilled(at, {at.x + size.x, at.y + size.y}, IM_COL32(29, 31, 36, 255), 4.0f);
    const float span = spanOf(report), width = size.x / kBars;
    const int count = std::min(kBars, int(report.history.size()));
    for (int i = 0; i < count; ++i) {
        const FrameSample& sample = report.history[report.history.size() - size_t(count) + size_t(i)];
        const float left = at.x + float(kBars - count + i) * width;
        float base = at.y + size.y;
        // What no pass accounts for is the CPU's share, on top.
        const float top = base - size.y * std::min(sample.ms / span, 1.0f);
        list->AddRectFilled({left, top}, {left + std::max(1.0f, width - 1.0f), base},
                            IM_COL32(70, 74, 84, 255));
        for (size_t pass = 0; pass < kPassNames.size(); ++pass) {
            const float height = size.y * std::min(float(passMs(sample, kPassNames[pass])) / span, 1.0f);
            if (height == 0.0f)
                continue;
            list->AddRectFilled({left, std::max(base - height, top)},
                                {left + std::max(1.0f, width - 1.0f), base}, kPassColours[pass]);
            base = std::max(base - height, top);
        }
    }
    if (budgetMs > 0.0 && budgetMs < span) {
        const float y = at.y + size.y * (1.0f - float(budgetMs) / span);
        list->AddLine({at.x, y}, {at.x + size.x, y}, kWarning);
    }
    const std::string text = fmt::format("{:.0f} ms", span);
    list->AddText({at.x + 5.0f, at.y + 2.0f}, kFaint, text.c_str());
}

void drawPasses(const FrameSample& newest)
{
    const float column = 4.6f * ImGui::GetFontSize(), number = 4.6f * ImGui::GetFontSize();
    double most = 1e-3;
    for (const auto& [name, ms] : newest.passMs)
        most = std::max(most, ms);
    for (size_t pass = 0; pass < kPassNames.size(); ++pass) {
        const double ms = passMs(newest, kPassNames[pass]);
        const ImVec2 at = ImGui::GetCursorScreenPos();
        const float width = ImGui::GetContentRegionAvail().x, height = rowHeight();
        ImDrawList* list = ImGui::GetWindowDrawList();
        list->AddText(at, ms > 0.0 ? kText : kFaint, kPassNames[pass]);
        bar(float(ms / most), kPassColours[pass], {at.x + column, at.y + 0.25f * height},
            {width - column - number, 0.5f * height});
        const std::string text = fmt::format("{:.{}f} ms", ms, ms < 100.0 ? 1 : 0);
        list->AddText({at.x + width - ImGui::CalcTextSize(text.c_str()).x, at.y}, ms > 0.0 ? kText : kFaint,
                      text.c_str());
        ImGui::Dummy({width, height - ImGui::GetStyle().ItemSpacing.y});
    }
}

void figure(const char* name, const std::string& value)
{
    ImGui::PushStyleColor(ImGuiCol_Text, kFaint);
    ImGui::TextUnformatted(name);
    ImGui::PopStyleColor();
    ImGui::SameLine(8.2f * ImGui::GetFontSize());
    ImGui::TextUnformatted(value.c_str());
}

std::string thousands(size_t number)
{
    if (number < 1000)
        return std::to_string(number);
    return fmt::format("{} {:03}", thousands(number / 1000), number % 1000);
}

void drawLumels(const FrameStats& f)
{
    figure("Marked",
           fmt::format("{} lumels in {} tiles", thousands(f.lumelsMarked), thousands(f.tilesMarked)));
    figure("Lit", fmt::format("{} lumels in {} tiles", thousands(f.lumelsLit), thousands(f.tilesLit)));
    figure("Derived", thousands(f.lumelsDerived) + " lumels");
    figure("Kept", thousands(f.lumelsKept) + " lumels");
    figure("Pending", thousands(f.lumelsPending) + " lumels");
    const double pixels = double(std::max<size_t>(f.pixelsCovered, 1));
    figure("Density", fmt::format("{:.2f} lumels per covered pixel", double(f.lumelsMarked) / pixels));
    figure("Level offset",
           fmt::format("{:.2f} + {:.2f} memory + {:.2f} budget", f.levelOffset, f.levelBias, f.budgetBias));
    figure("Render scale", fmt::format("{:.2f}", f.renderScale));
    figure("Objects", fmt::format("{} texture space, {} forward, {} culled", f.objectsTsl, f.objectsForward,
                                  f.objectsCulled));
    figure("Pool", fmt::format("{} of {} MiB, {} textures", f.poolUsedBytes >> 20, f.poolCapBytes >> 20,
                               f.poolTextures));
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const ImVec2 size{ImGui::GetContentRegionAvail().x, 0.6f * ImGui::GetFontSize()};
    ImGui::Dummy(size);
    bar(f.poolCapBytes ? float(double(f.poolUsedBytes) / double(f.poolCapBytes)) : 0.0f, kAccent, at, size);
}

void drawMemory(const gpu::MemoryReport& memory)
{
    // By gpu::MemoryKind.
    constexpr std::array<const char*, gpu::kMemoryKindNames.size()> kLabels{
        "Lit textures", "Surface cache", "Materials", "Geometry",
        "Texel maps",   "Targets",       "Buffers",   "Staging"};
    const auto mebibytes = [](uint64_t bytes) {
        return fmt::format("{:.1f} MiB", double(bytes) / (1 << 20));
    };
    figure("GPU memory",
           fmt::format("{} in {} allocations", mebibytes(memory.usedBytes()), memory.allocations));
    for (size_t kind = 0; kind < kLabels.size(); ++kind)
        figure(kLabels[kind], mebibytes(memory.bytes[kind]));
}

} // namespace

float frameTimesHeight()
{
    return ImGui::GetTextLineHeightWithSpacing() + graphHeight() +
           (float(kPassNames.size()) + 0.4f) * rowHeight() + ImGui::GetStyle().ItemSpacing.y;
}

// "24.6 ms   31 FPS   budget 33 ms", and what the picture is.
static void drawFrameTime(const ViewState& state, const ViewReport& report)
{
    const FrameRate rate = frameRate(report.history);
    ImGui::TextUnformatted("Frame");
    ImGui::SameLine(4.6f * ImGui::GetFontSize());
    if (rate.ms > 0.0f)
        ImGui::Text("%.1f ms", rate.ms);
    if (rate.perSecond > 0.0f) {
        ImGui::SameLine();
        ImGui::Text("  %.0f FPS", rate.perSecond);
    }
    if (state.settings.budgetMs > 0.0) {
        ImGui::SameLine();
        ImGui::TextDisabled("  budget %.0f ms", state.settings.budgetMs);
    }
    const char* const words = state.paused ? "paused" : report.finished ? "finished" : "refining";
    ImGui::SameLine(ImGui::GetContentRegionMax().x - ImGui::CalcTextSize(words).x);
    ImGui::TextColored(ImGui::ColorConvertU32ToFloat4(report.finished && !state.paused ? kFaint : kAccent),
                       "%s", words);
}

void drawFrameTimes(const ViewState& state, const ViewReport& report)
{
    ImGui::Separator();
    const FrameSample newest = report.history.empty() ? FrameSample{} : report.history.back();
    drawFrameTime(state, report);
    drawGraph(report, state.settings.budgetMs);
    drawPasses(newest);
}

void drawLumelsTab(ViewState& state, const ViewReport& report)
{
    drawSettings(state, Panel::lumels);
    ImGui::Separator();
    const FrameStats& f = report.sides[0].stats;
    if (state.sides[0].shading == Shading::tsl)
        drawLumels(f);
    else
        ImGui::TextDisabled(state.split ? "The left side does not use texture-space lighting."
                                        : "This picture does not use texture-space lighting.");
    ImGui::Separator();
    drawMemory(f.memory);
}

} // namespace lumel::ui
