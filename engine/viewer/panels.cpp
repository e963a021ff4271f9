#include "panels.h"
#include "setting_widgets.h"
#include <cmath>

namespace lumel::ui {
namespace {

void drawSide(const char* title, int index, Side& side)
{
    ImGui::PushID(index);
    ImGui::TextColored(ImGui::ColorConvertU32ToFloat4(kAccent), "%s", title);
    combo("Shading", "##shading", side.shading, kShadingNames);
    // The reference reads level 0, which all filters share.
    if (side.shading != Shading::reference)
        combo("Filter", "##filter", side.filter, kFilterNames);
    ImGui::PopID();
}

void drawDisplay(ViewState& state)
{
    label("Exposure", "multiplies radiance before tone mapping; auto brings the view to middle grey");
    state.exposureChosen |= ImGui::Checkbox("auto", &state.autoExposure);
    ImGui::SameLine();
    ImGui::SetNextItemWidth(-FLT_MIN);
    if (ImGui::SliderFloat("##exposure", &state.settings.exposure, 1e-5f, 1e4f, "%.3g",
                           ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_AlwaysClamp)) {
        state.autoExposure = false;
        state.exposureChosen = true;
    }
    drawSettings(state, Panel::picture);
}

void drawCamera(ViewState& state, const ViewReport& report)
{
    if (report.scene && !report.scene->cameras.empty()) {
        label("Camera");
        const std::string& name = state.camera.camera().name;
        if (ImGui::BeginCombo("##camera", state.camera.moved() ? "moved" : name.c_str())) {
            for (size_t i = 0; i < report.scene->cameras.size(); ++i) {
                ImGui::PushID(int(i));
                if (ImGui::Selectable(report.scene->cameras[i].name.c_str()))
                    state.requests.camera = int(i);
                ImGui::PopID();
            }
            ImGui::EndCombo();
        }
    }
    label("Field of view");
    float fov = state.camera.fovDegrees();
    if (ImGui::SliderFloat("##fov", &fov, 5.0f, 120.0f, "%.0f degrees", ImGuiSliderFlags_AlwaysClamp))
        state.camera.setFovDegrees(fov);
    const scene::Camera& camera = state.camera.camera();
    label("Position");
    ImGui::Text("%.3f  %.3f  %.3f", camera.eye.x, camera.eye.y, camera.eye.z);
    label("Target");
    ImGui::Text("%.3f  %.3f  %.3f", camera.target.x, camera.target.y, camera.target.z);
}

} // namespace

void drawPictureTab(ViewState& state, const ViewReport& report)
{
    drawSide(state.split ? "Left" : "Picture", 0, state.sides[0]);
    ImGui::Checkbox("Compare with a second picture (X)", &state.split);
    if (state.split)
        drawSide("Right", 1, state.sides[1]);
    ImGui::Separator();
    drawDisplay(state);
    ImGui::Separator();
    drawCamera(state, report);
    ImGui::Separator();
    const float half = 0.5f * (ImGui::GetContentRegionAvail().x - ImGui::GetStyle().ItemSpacing.x);
    if (ImGui::Button("Copy as command", {half, 0}))
        state.requests.copyCommand = true;
    ImGui::SameLine();
    if (ImGui::Button("Screenshot", {-FLT_MIN, 0}))
        state.requests.screenshotPng = true;
    combo("Present mode", "##present", state.presentMode,
          std::array{"FIFO (vertical sync)", "mailbox", "immediate"});
    ImGui::Checkbox("Continuous rendering", &state.continuous);
}

static void drawBar(const Layout& layout, ViewState& state, const ViewReport& report)
{
    ImGui::SetNextWindowPos({layout.picture.x, 0.0f});
    ImGui::SetNextWindowSize({layout.bar, layout.window.y});
    ImGui::Begin("panels", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                     ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoScrollWithMouse);
    const float below = frameTimesHeight();
    state.materialTab = false;
    ImGui::BeginChild("tabs", {0.0f, -below});
    if (ImGui::BeginTabBar("bar")) {
        const auto tab = [](const char* name, auto draw) {
            if (!ImGui::BeginTabItem(name))
                return;
            ImGui::BeginChild(name);
            draw();
            ImGui::EndChild();
            ImGui::EndTabItem();
        };
        tab("Picture", [&] { drawPictureTab(state, report); });
        tab("Lumels", [&] { drawLumelsTab(state, report); });
        tab("Objects", [&] { drawObjectsTab(state, report); });
        tab("Lights", [&] { drawLightsTab(state, report); });
        tab("Material", [&] {
            state.materialTab = true;
            drawMaterialTab(report);
        });
        ImGui::EndTabBar();
    }
    ImGui::EndChild();
    drawFrameTimes(state, report);
    ImGui::End();
}

void drawPanels(ViewState& state, const ViewReport& report, const Layout& layout)
{
    drawOverlay(state, report, layout);
    if (state.panels)
        drawBar(layout, state, report);
    if (state.help)
        drawHelp(state, layout);
}

} // namespace lumel::ui
