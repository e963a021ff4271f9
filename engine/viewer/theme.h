// Colours, spacing and font of the panels, and where they are in the window.
#pragma once
#include "view_state.h"
#include <imgui.h>

namespace lumel::ui {

inline constexpr std::array<float, 3> kBackground{0.055f, 0.058f, 0.066f}; // behind the picture, sRGB
inline constexpr ImU32 kAccent = IM_COL32(236, 168, 72, 255);
inline constexpr ImU32 kFaint = IM_COL32(150, 154, 164, 255);
inline constexpr ImU32 kText = IM_COL32(228, 229, 232, 255);
inline constexpr ImU32 kWarning = IM_COL32(240, 110, 90, 255);
inline constexpr ImU32 kShade = IM_COL32(12, 13, 16, 205); // under text on the picture

// `scale`: pixels of the window per pixel at 96 dpi, for high-DPI displays. Before the font is uploaded.
void applyTheme(float scale);

// Window coordinates. The panels are a bar at the right; the picture has all the rest, so that nothing
// overlaps at any size.
struct Layout {
    float scale = 1.0f;
    ImVec2 window{0.0f, 0.0f};
    float bar = 0.0f;           // width of the panels, 0 = hidden
    ImVec2 picture{0.0f, 0.0f}; // size; its corner is (0, 0)
};
Layout layoutOf(const ViewState& state, ImVec2 window, float scale);

// A label in the left column, with a tooltip where there is one; the next widget fills the rest of the row.
void label(const char* text, const char* tooltip = nullptr);

} // namespace lumel::ui
