// The bar of panels at the window's right, and what is drawn on the picture.
#pragma once
#include "theme.h"

namespace lumel::ui {

// All of it, between ImGui::NewFrame() and ImGui::Render().
void drawPanels(ViewState& state, const ViewReport& report, const Layout& layout);

// The parts, a file each.
void drawPictureTab(ViewState& state, const ViewReport& report);
void drawLumelsTab(ViewState& state, const ViewReport& report);
void drawObjectsTab(ViewState& state, const ViewReport& report);
void drawLightsTab(ViewState& state, const ViewReport& report);
void drawMaterialTab(const ViewReport& report);
void drawFrameTimes(const ViewState& state, const ViewReport& report);
float frameTimesHeight();
void drawOverlay(const ViewState& state, const ViewReport& report, const Layout& layout);
// A few keys, until they are dismissed, which is remembered from one run to the next.
void drawHint(const Layout& layout);
bool hintWanted();
void rememberHint();
void drawHelp(ViewState& state, const Layout& layout);

} // namespace lumel::ui
