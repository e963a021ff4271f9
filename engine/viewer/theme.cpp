#include "theme.h"
#include <filesystem>

namespace lumel::ui {
namespace {

ImVec4 rgb(int hex, float alpha = 1.0f)
{
    return {float(hex >> 16 & 255) / 255.0f, float(hex >> 8 & 255) / 255.0f, float(hex & 255) / 255.0f,
            alpha};
}

void applyColours(ImGuiStyle& style)
{
    ImVec4* c = style.Colors;
    c[ImGuiCol_Text] = rgb(0xe4e5e8);
    c[ImGuiCol_TextDisabled] = rgb(0x969aa4);
    c[ImGuiCol_WindowBg] = rgb(0x17181c);
    c[ImGuiCol_ChildBg] = rgb(0x17181c);
    c[ImGuiCol_PopupBg] = rgb(0x1d1f24, 0.98f);
    c[ImGuiCol_Border] = rgb(0x2c2f36);
    c[ImGuiCol_FrameBg] = rgb(0x25282e);
    c[ImGuiCol_FrameBgHovered] = rgb(0x2f333b);
    c[ImGuiCol_FrameBgActive] = rgb(0x3a3f49);
    c[ImGuiCol_TitleBg] = c[ImGuiCol_TitleBgActive] = rgb(0x1d1f24);
    c[ImGuiCol_ScrollbarBg] = rgb(0x17181c);
    c[ImGuiCol_ScrollbarGrab] = rgb(0x3a3f49);
    c[ImGuiCol_ScrollbarGrabHovered] = c[ImGuiCol_ScrollbarGrabActive] = rgb(0x4a505c);
    c[ImGuiCol_CheckMark] = c[ImGuiCol_SliderGrab] = rgb(0xeca848);
    c[ImGuiCol_SliderGrabActive] = rgb(0xf6c377);
    c[ImGuiCol_Button] = rgb(0x2f333b);
    c[ImGuiCol_ButtonHovered] = rgb(0x3d434e);
    c[ImGuiCol_ButtonActive] = rgb(0x4a505c);
    c[ImGuiCol_Header] = rgb(0xeca848, 0.24f);
    c[ImGuiCol_HeaderHovered] = rgb(0xeca848, 0.16f);
    c[ImGuiCol_HeaderActive] = rgb(0xeca848, 0.34f);
    c[ImGuiCol_Separator] = rgb(0x2c2f36);
    c[ImGuiCol_Tab] = rgb(0x1d1f24);
    c[ImGuiCol_TabHovered] = rgb(0x3a3f49);
    c[ImGuiCol_TabActive] = c[ImGuiCol_TabUnfocusedActive] = rgb(0x33373f);
    c[ImGuiCol_TabUnfocused] = rgb(0x1d1f24);
    c[ImGuiCol_TableHeaderBg] = rgb(0x1d1f24);
    c[ImGuiCol_TableBorderLight] = c[ImGuiCol_TableBorderStrong] = rgb(0x2c2f36);
    c[ImGuiCol_TableRowBgAlt] = rgb(0xffffff, 0.02f);
    c[ImGuiCol_PlotHistogram] = rgb(0xeca848);
    c[ImGuiCol_NavHighlight] = rgb(0xeca848);
}

} // namespace

void applyTheme(float scale)
{
    ImGuiStyle& style = ImGui::GetStyle();
    style = ImGuiStyle();
    applyColours(style);
    style.WindowPadding = {12, 10};
    style.FramePadding = {8, 4};
    style.ItemSpacing = {8, 6};
    style.ItemInnerSpacing = {6, 4};
    style.CellPadding = {6, 3};
    style.ScrollbarSize = 11;
    style.GrabMinSize = 10;
    style.WindowBorderSize = 0;
    style.FrameRounding = style.GrabRounding = style.TabRounding = 4;
    style.PopupRounding = style.ScrollbarRounding = 5;
    style.WindowRounding = 0;
    style.ScaleAllSizes(scale);

    ImGuiIO& io = ImGui::GetIO();
    io.Fonts->Clear();
    constexpr float kPoints = 14.0f;
    const char* const file = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";
    if (std::filesystem::exists(file))
        io.Fonts->AddFontFromFileTTF(file, std::round(kPoints * scale));
    else {
        ImFontConfig config;
        config.SizePixels = std::round(13.0f * scale); // its native size, where it is crisp
        io.Fonts->AddFontDefault(&config);
    }
}

Layout layoutOf(const ViewState& state, ImVec2 window, float scale)
{
    Layout layout{.scale = scale, .window = window};
    layout.bar = state.panels ? std::floor(std::min(372.0f * scale, 0.6f * window.x)) : 0.0f;
    layout.picture = {std::max(1.0f, window.x - layout.bar), std::max(1.0f, window.y)};
    return layout;
}

void label(const char* text, const char* tooltip)
{
    ImGui::AlignTextToFramePadding();
    ImGui::PushStyleColor(ImGuiCol_Text, kFaint);
    ImGui::TextUnformatted(text);
    ImGui::PopStyleColor();
    if (tooltip && ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) {
        ImGui::BeginTooltip();
        ImGui::PushTextWrapPos(24.0f * ImGui::GetFontSize());
        ImGui::TextUnformatted(tooltip);
        ImGui::PopTextWrapPos();
        ImGui::EndTooltip();
    }
    ImGui::SameLine(8.2f * ImGui::GetFontSize());
    ImGui::SetNextItemWidth(-FLT_MIN);
}

} // namespace lumel::ui
