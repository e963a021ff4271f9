// What is drawn on the picture: the split and its labels, messages, progress, the selected object's box.
#include "panels.h"
#include "renderer/names.h"
#include "scene/pick.h"
#include <algorithm>
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>

namespace lumel::ui {
namespace {

struct Key {
    const char* keys;
    const char* what;
};
constexpr Key kKeys[] = {{"Left drag", "orbit the target"},
                         {"Right drag", "look around"},
                         {"Middle drag, Shift + left", "pan"},
                         {"Wheel", "dolly in and out"},
                         {"W A S D, Q E", "fly; faster with Shift"},
                         {"Click, double click", "select an object, focus on it"},
                         {"1 2 3", "texture space, forward or reference on the side of the cursor"},
                         {"F, Shift + F", "next, previous filter on the side of the cursor"},
                         {"V, Shift + V", "next, previous debug view"},
                         {"X", "compare two pictures; drag the line between them"},
                         {"C", "copy as command"},
                         {"F12, Shift + F12", "screenshot as PNG, EXR, with its command in a text file"},
                         {"R", "reload the shaders"},
                         {"P", "play or pause the scene's animation"},
                         {"Space, .", "pause rendering, step one frame"},
                         {"H", "hide or show the panels"},
                         {"F11", "full screen"},
                         {"Home", "reset the view"},
                         {"?, F1", "this help"},
                         {"Ctrl + Q", "quit"}};

// Text on a dark background, with its upper left (or right) corner there.
void note(const std::string& text, ImVec2 at, float scale, ImU32 colour, bool toTheLeft = false)
{
    const ImVec2 size = ImGui::CalcTextSize(text.c_str());
    const ImVec2 pad{9.0f * scale, 5.0f * scale};
    if (toTheLeft)
        at.x -= size.x + 2.0f * pad.x;
    ImDrawList* list = ImGui::GetBackgroundDrawList();
    list->AddRectFilled(at, {at.x + size.x + 2.0f * pad.x, at.y + size.y + 2.0f * pad.y}, kShade,
                        4.0f * scale);
    list->AddText({at.x + pad.x, at.y + pad.y}, colour, text.c_str());
}

std::string describe(const Side& side, const SideReport& report, bool psnr)
{
    std::string text = side.shading == Shading::tsl       ? "Texture space"
                       : side.shading == Shading::forward ? "Forward"
                                                          : "Reference";
    if (side.shading == Shading::reference)
        return text + fmt::format(", {} samples", report.samples);
    text += fmt::format(", {}", kFilterNames[size_t(side.filter)]);
    if (psnr)
        text += report.psnr ? fmt::format(": {:.1f} dB", *report.psnr) : ": ...";
    return text;
}

void drawSplit(const ViewState& state, const ViewReport& report, const Layout& layout)
{
    const float margin = 10.0f * layout.scale;
    if (!report.scene)
        return;
    if (!state.split) {
        note(describe(state.sides[0], report.sides[0], false), {margin, margin}, layout.scale, kText);
    } else {
        const float x = std::round(state.splitAt * layout.picture.x);
        ImDrawList* list = ImGui::GetBackgroundDrawList();
        list->AddLine({x, 0.0f}, {x, layout.picture.y}, IM_COL32(255, 255, 255, 220), 1.5f * layout.scale);
        const float middle = 0.5f * layout.picture.y, grip = 5.0f * layout.scale;
        list->AddRectFilled({x - grip, middle - 4.0f * grip}, {x + grip, middle + 4.0f * grip},
                            IM_COL32(255, 255, 255, 235), grip);
        const bool measured = state.settings.view == View::none;
        // Two rows, so that long labels never overlap.
        const float row = ImGui::GetFontSize() + 16.0f * layout.scale;
        note(describe(state.sides[0], report.sides[0], measured), {margin, margin}, layout.scale, kText);
        note(describe(state.sides[1], report.sides[1], measured), {layout.picture.x - margin, margin + row},
             layout.scale, kText, true);
        if (report.referenceSamples > 0)
            note(fmt::format("PSNR against {} samples per pixel", report.referenceSamples),
                 {margin, margin + row}, layout.scale, kFaint);
    }
    if (state.settings.view != View::none)
        note(fmt::format("view: {}", kViewNames[size_t(state.settings.view)]),
             {margin, layout.picture.y - margin - ImGui::GetFontSize() - 10.0f * layout.scale}, layout.scale,
             kAccent);
}

// The box's edges, clipped at the near plane.
void drawSelection(const ViewState& state, const ViewReport& report, const Layout& layout)
{
    if (!report.scene || !state.selected || *state.selected >= report.scene->objects.size())
        return;
    const scene::Object& object = report.scene->objects[*state.selected];
    const Bounds box = objectBounds(*report.scene, *state.selected);
    const scene::Camera& camera = state.camera.camera();
    const glm::mat4 clipFromObject =
        reversedPerspective(camera.yFov, layout.picture.x / layout.picture.y, camera.nearMetres) *
        glm::lookAt(camera.eye, camera.target, camera.up) * object.worldFromObject;
    const auto corner = [&](int i) {
        return clipFromObject * glm::vec4(i & 1 ? box.upper.x : box.lower.x,
                                          i & 2 ? box.upper.y : box.lower.y,
                                          i & 4 ? box.upper.z : box.lower.z, 1.0f);
    };
    const auto place = [&](glm::vec4 p) {
        return ImVec2((0.5f + 0.5f * p.x / p.w) * layout.picture.x,
                      (0.5f + 0.5f * p.y / p.w) * layout.picture.y);
    };
    ImDrawList* list = ImGui::GetBackgroundDrawList();
    list->PushClipRect({0.0f, 0.0f}, layout.picture);
    for (int i = 0; i < 8; ++i)
        for (const int axis : {1, 2, 4}) {
            if (i & axis)
                continue;
            glm::vec4 a = corner(i), b = corner(i | axis);
            const float least = camera.nearMetres;
            if (a.w < least && b.w < least)
                continue;
            if (a.w < least)
                std::swap(a, b);
            if (b.w < least)
                b = glm::mix(a, b, (a.w - least) / (a.w - b.w));
            list->AddLine(place(a), place(b), kAccent, 1.5f * layout.scale);
        }
    list->PopClipRect();
}

void drawProgress(const ViewReport& report, const Layout& layout)
{
    if (report.loading.empty())
        return;
    const float s = layout.scale, width = std::min(420.0f * s, layout.picture.x - 24.0f * s);
    const ImVec2 at{0.5f * (layout.picture.x - width), layout.picture.y - 76.0f * s};
    ImDrawList* list = ImGui::GetForegroundDrawList();
    list->AddRectFilled(at, {at.x + width, at.y + 52.0f * s}, kShade, 6.0f * s);
    list->PushClipRect(at, {at.x + width - 8.0f * s, at.y + 52.0f * s});
    list->AddText({at.x + 12.0f * s, at.y + 8.0f * s}, kText, report.loading.c_str());
    list->PopClipRect();
    const ImVec2 from{at.x + 12.0f * s, at.y + 34.0f * s}, to{at.x + width - 12.0f * s, at.y + 42.0f * s};
    list->AddRectFilled(from, to, IM_COL32(50, 54, 62, 255), 3.0f * s);
    const float filled = (to.x - from.x) * std::clamp(report.loadingShare, 0.0f, 1.0f);
    if (filled >= 1.0f)
        list->AddRectFilled(from, {from.x + filled, to.y}, kAccent, 3.0f * s);
}

void drawMessage(const ViewReport& report, const Layout& layout)
{
    if (report.message.empty() || glfwGetTime() > report.messageUntil)
        return;
    const float s = layout.scale, width = std::min(760.0f * s, layout.picture.x - 24.0f * s);
    const ImVec2 size = ImGui::CalcTextSize(report.message.c_str(), nullptr, false, width - 24.0f * s);
    const ImVec2 at{12.0f * s, layout.picture.y - size.y - 96.0f * s};
    ImDrawList* list = ImGui::GetForegroundDrawList();
    list->AddRectFilled(at, {at.x + size.x + 24.0f * s, at.y + size.y + 16.0f * s}, kShade, 6.0f * s);
    list->AddText(ImGui::GetFont(), ImGui::GetFontSize(), {at.x + 12.0f * s, at.y + 8.0f * s},
                  report.messageIsError ? kWarning : kText, report.message.c_str(), nullptr,
                  width - 24.0f * s);
}

} // namespace

void drawOverlay(const ViewState& state, const ViewReport& report, const Layout& layout)
{
    drawSelection(state, report, layout);
    drawSplit(state, report, layout);
    if (state.hint && report.scene && report.loading.empty())
        drawHint(layout);
    drawMessage(report, layout);
    drawProgress(report, layout);
}

void drawHelp(ViewState& state, const Layout& layout)
{
    ImGui::SetNextWindowPos({0.5f * layout.picture.x, 0.5f * layout.picture.y}, ImGuiCond_Always,
                            {0.5f, 0.5f});
    ImGui::SetNextWindowFocus();
    ImGui::Begin("Keys", &state.help,
                 ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoSavedSettings |
                     ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoCollapse);
    if (ImGui::BeginTable("keys", 2)) {
        for (const Key& key : kKeys) {
            ImGui::TableNextRow();
            ImGui::TableNextColumn();
            ImGui::TextColored(ImGui::ColorConvertU32ToFloat4(kAccent), "%s", key.keys);
            ImGui::TableNextColumn();
            ImGui::TextUnformatted(key.what);
        }
        ImGui::EndTable();
    }
    ImGui::End();
}

} // namespace lumel::ui
