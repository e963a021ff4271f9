// The material inspector: the texel under the cursor on the disc of half vectors.
#include "panels.h"
#include <algorithm>
#include <fmt/format.h>

namespace lumel::ui {
namespace {

// Dark violet through orange to pale yellow at the average's peak; beyond it ice blue.
ImU32 heat(float valueOverPeak)
{
    static const ImVec4 kStops[] = {{5, 6, 12, 1},      {38, 17, 84, 1},    {106, 28, 110, 1},
                                    {172, 46, 88, 1},   {226, 88, 52, 1},   {250, 157, 36, 1},
                                    {252, 224, 110, 1}, {255, 255, 225, 1}, {143, 219, 255, 1}};
    // Logarithmic, so that the foot of a lobe shows.
    constexpr float kSteepness = 60.0f;
    const float t = std::log1p(kSteepness * std::max(valueOverPeak, 0.0f)) / std::log1p(kSteepness);
    const float at = std::clamp(t * 7.0f, 0.0f, 7.999f);
    const ImVec4 &a = kStops[int(at)], &b = kStops[int(at) + 1];
    const float mix = at - std::floor(at);
    const auto channel = [mix](float x, float y) { return int(x + mix * (y - x)); };
    return IM_COL32(channel(a.x, b.x), channel(a.y, b.y), channel(a.z, b.z), 255);
}

// The back end has one texture, the font's: a picture is a mesh of coloured corners.
void drawDisc(const DiscPicture& picture, const Inspection& view, ImVec2 at, float size)
{
    ImDrawList* list = ImGui::GetWindowDrawList();
    const int side = view.side;
    const float step = size / float(side - 1);
    const ImVec2 white = ImGui::GetFontTexUvWhitePixel();
    list->AddRectFilled(at, {at.x + size, at.y + size}, IM_COL32(14, 15, 18, 255));
    const auto value = [&](int x, int y) { return picture.values[size_t(y * side + x)]; };
    for (int y = 0; y + 1 < side; ++y) {
        list->PrimReserve(6 * (side - 1), 2 * side);
        const auto first = ImDrawIdx(list->_VtxCurrentIdx);
        for (int x = 0; x < side; ++x)
            for (int row = 0; row < 2; ++row) {
                const float v = value(x, y + row);
                list->PrimWriteVtx({at.x + float(x) * step, at.y + float(y + row) * step}, white,
                                   v < 0.0f ? IM_COL32(14, 15, 18, 255) : heat(v / float(view.peak)));
            }
        for (int x = 0; x + 1 < side; ++x)
            for (const int corner : {0, 1, 2, 2, 1, 3})
                list->PrimWriteIdx(ImDrawIdx(first + 2 * x + corner));
    }
    list->PushClipRect(at, {at.x + size, at.y + size}, true);
    const auto place = [&](double x, double y) {
        return ImVec2(at.x + float((x - view.centreX + view.half) / (2.0 * view.half)) * size,
                      at.y + float((view.centreY + view.half - y) / (2.0 * view.half)) * size);
    };
    for (const double radius : {0.25, 0.5, 0.75, 1.0})
        list->AddCircle(place(0.0, 0.0), float(radius / (2.0 * view.half)) * size,
                        IM_COL32(255, 255, 255, radius == 1.0 ? 90 : 36), 96);
    const ImVec2 pole = place(0.0, 0.0);
    list->AddLine({pole.x - 4.0f, pole.y}, {pole.x + 4.0f, pole.y}, IM_COL32(255, 255, 255, 90));
    list->AddLine({pole.x, pole.y - 4.0f}, {pole.x, pole.y + 4.0f}, IM_COL32(255, 255, 255, 90));
    list->PopClipRect();
}

void drawDiscs(const Inspection& view)
{
    const float gap = ImGui::GetStyle().ItemSpacing.x;
    const float size = std::floor((ImGui::GetContentRegionAvail().x - 2.0f * gap) / 3.0f);
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float line = ImGui::GetTextLineHeight();
    ImGui::Dummy({3.0f * size + 2.0f * gap, size + 2.4f * line});
    ImDrawList* list = ImGui::GetWindowDrawList();
    const std::string fit = fmt::format("error {:.3f}", view.fit.error);
    const std::string lean = fmt::format("error {:.3f}", view.lean.error);
    const struct {
        const DiscPicture& picture;
        const char* name;
        std::string note;
    } columns[] = {
        {view.average, "Average", "exact"}, {view.fit, "Baked lobe", fit}, {view.lean, "LEAN", lean}};
    float x = at.x;
    for (const auto& column : columns) {
        drawDisc(column.picture, view, {x, at.y}, size);
        list->AddText({x, at.y + size + 0.2f * line}, kText, column.name);
        list->AddText({x, at.y + size + 1.25f * line}, kFaint, column.note.c_str());
        x += size + gap;
    }
}

void row(const char* name, const std::string& value)
{
    ImGui::PushStyleColor(ImGuiCol_Text, kFaint);
    ImGui::TextUnformatted(name);
    ImGui::PopStyleColor();
    ImGui::SameLine(8.2f * ImGui::GetFontSize());
    ImGui::TextUnformatted(value.c_str());
}

} // namespace

void drawMaterialTab(const ViewReport& report)
{
    const Inspection& view = report.inspection;
    if (!view.valid) {
        ImGui::PushTextWrapPos();
        ImGui::TextDisabled("Move the cursor over a surface to inspect the reflectance of the texel there.");
        ImGui::PopTextWrapPos();
        return;
    }
    using namespace baker;
    const auto& b = view.baked;
    row("Material", view.material);
    row("Texel", fmt::format("{}, {} of {} x {}", view.texel.x, view.texel.y, view.width, view.height));
    row("Level", std::to_string(view.texel.level));
    ImGui::Spacing();
    drawDiscs(view);
    ImGui::PushTextWrapPos();
    ImGui::TextDisabled(
        "Reflectance over half vectors; %s. Rings at sines of 1/4, 1/2, 3/4 and 1. LEAN's lobe is "
        "scaled to its least error.",
        view.half >= 1.0 ? "the whole disc" : fmt::format("{:.2f} of the disc across", view.half).c_str());
    ImGui::PopTextWrapPos();
    ImGui::Separator();
    row("Normal", fmt::format("{:.4f}  {:.4f}", b[kNx], b[kNy]));
    row("Covariance", fmt::format("{:.5f}  {:.5f}  {:.5f}", b[kSxx], b[kSxy], b[kSyy]));
    row("Specular", fmt::format("{:.4f}  {:.4f}  {:.4f}", b[kKsR], b[kKsG], b[kKsB]));
    row("Diffuse", fmt::format("{:.4f}  {:.4f}  {:.4f}", b[kKdR], b[kKdG], b[kKdB]));
    row("Fit error", fmt::format("{:.4f}", b[kError]));
}

} // namespace lumel::ui
