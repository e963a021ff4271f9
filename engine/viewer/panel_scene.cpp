// The scene's objects and lights.
#include "panels.h"
#include <fmt/format.h>

namespace lumel::ui {
namespace {

void drawObjectRow(ViewState& state, const ViewReport& report, size_t i)
{
    const scene::Object& object = report.scene->objects[i];
    const bool known = i < report.residency.size();
    const bool lit = known && report.residency[i].texture;
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::PushID(int(i));
    if (ImGui::Selectable(object.name.empty() ? "(no name)" : object.name.c_str(), state.selected == i,
                          ImGuiSelectableFlags_SpanAllColumns))
        state.selected = state.selected == i ? std::nullopt : std::optional(i);
    const std::string& problem = report.scene->meshes[size_t(object.mesh)].uvProblem;
    if (ImGui::IsItemHovered() && !problem.empty())
        ImGui::SetTooltip("drawn forward: %s", problem.c_str());
    ImGui::PopID();
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(lit ? report.residency[i].share < 1.0f ? "fading" : "lit" : "forward");
    ImGui::TableNextColumn();
    if (lit)
        ImGui::Text("%u", report.residency[i].litLevel);
    ImGui::TableNextColumn();
    if (lit && i < report.lumelGrids.size()) {
        const glm::uvec2 size =
            glm::max(report.lumelGrids[i] >> report.residency[i].litLevel, glm::uvec2(1u));
        ImGui::Text("%u x %u", size.x, size.y);
    }
}

bool drawLight(scene::Light& light)
{
    bool changed = false;
    int type = int(light.type);
    label("Type");
    if (ImGui::Combo("##type", &type, "sun\0point\0spot\0")) {
        light.type = scene::LightType(type);
        changed = true;
    }
    label("Colour");
    changed |= ImGui::ColorEdit3("##colour", &light.colour.x, ImGuiColorEditFlags_Float);
    label("Intensity");
    changed |=
        ImGui::DragFloat("##intensity", &light.intensity, 0.01f * std::max(light.intensity, 0.1f), 0.0f, 1e6f,
                         type == 0 ? "%.3g lux" : "%.3g candela", ImGuiSliderFlags_AlwaysClamp);
    if (type != 0) {
        label("Position");
        changed |= ImGui::DragFloat3("##position", &light.position.x, 0.01f, 0.0f, 0.0f, "%.2f");
        label("Range");
        changed |=
            ImGui::DragFloat("##range", &light.range, 0.05f, 0.0f, 1e6f,
                             light.range > 0.0f ? "%.2f m" : "unlimited", ImGuiSliderFlags_AlwaysClamp);
    }
    if (type != 1) {
        label("Direction");
        glm::vec3 direction = light.direction;
        if (ImGui::DragFloat3("##direction", &direction.x, 0.01f, -1.0f, 1.0f, "%.2f") &&
            glm::length(direction) > 1e-3f) {
            light.direction = glm::normalize(direction);
            changed = true;
        }
    }
    if (type == 2) {
        label("Cone");
        float degrees[2] = {glm::degrees(light.innerCone), glm::degrees(light.outerCone)};
        if (ImGui::DragFloat2("##cone", degrees, 0.2f, 0.0f, 90.0f, "%.0f deg")) {
            degrees[1] = std::clamp(degrees[1], 1.0f, 90.0f);
            light.innerCone = glm::radians(std::clamp(degrees[0], 0.0f, degrees[1] - 0.5f));
            light.outerCone = glm::radians(degrees[1]);
            changed = true;
        }
    }
    return changed;
}

void drawEnvironment(ViewState& state, const ViewReport& report)
{
    Settings& s = state.settings;
    label("Environment");
    // A file stays in the list for as long as the viewer runs.
    static std::string file;
    if (state.environment != "none" && state.environment != "sky")
        file = state.environment;
    const std::string shown = std::filesystem::path(state.environment).filename().string();
    if (ImGui::BeginCombo("##environment", shown.c_str())) {
        for (const std::string& name : {std::string("none"), std::string("sky"), file})
            if (!name.empty() && ImGui::Selectable(std::filesystem::path(name).filename().c_str()))
                state.environment = name;
        ImGui::EndCombo();
    }
    if (ImGui::IsItemHovered())
        ImGui::SetTooltip("drop an equirectangular map on the window");
    if (state.environment != "none") {
        label("Their strength");
        ImGui::SliderFloat("##intensity", &s.environmentIntensity, 0.0f, 8.0f, "%.2f",
                           ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_AlwaysClamp);
        label("Turned by");
        ImGui::SliderFloat("##rotation", &s.environmentRotation, -180.0f, 180.0f, "%.0f degrees",
                           ImGuiSliderFlags_AlwaysClamp);
    }
    label("Ambient");
    float ambient = s.ambient.value_or(report.ambient);
    if (ImGui::SliderFloat("##ambient", &ambient, 0.0f, 100.0f, s.ambient ? "%.3g" : "%.3g (usual)",
                           ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_AlwaysClamp))
        s.ambient = ambient;
    if (ImGui::IsItemClicked(ImGuiMouseButton_Right))
        s.ambient.reset();
    if (ImGui::IsItemHovered())
        ImGui::SetTooltip("an even sky beside the environment; right click: the usual");
    label("Shadows");
    ImGui::Checkbox("##shadows", &s.shadows);
    ImGui::Separator();
}

} // namespace

void drawObjectsTab(ViewState& state, const ViewReport& report)
{
    if (!report.scene)
        return;
    ImGui::TextDisabled("%zu objects. Click here or in the picture.", report.scene->objects.size());
    const auto flags = ImGuiTableFlags_RowBg | ImGuiTableFlags_ScrollY | ImGuiTableFlags_BordersInnerH;
    if (!ImGui::BeginTable("objects", 4, flags))
        return;
    const float em = ImGui::GetFontSize();
    ImGui::TableSetupScrollFreeze(0, 1);
    ImGui::TableSetupColumn("Object", ImGuiTableColumnFlags_WidthStretch);
    ImGui::TableSetupColumn("Mode", ImGuiTableColumnFlags_WidthFixed, 3.8f * em);
    ImGui::TableSetupColumn("Level", ImGuiTableColumnFlags_WidthFixed, 2.8f * em);
    ImGui::TableSetupColumn("Lumels", ImGuiTableColumnFlags_WidthFixed, 6.4f * em);
    ImGui::TableHeadersRow();
    ImGuiListClipper clipper;
    clipper.Begin(int(report.scene->objects.size()));
    while (clipper.Step())
        for (int i = clipper.DisplayStart; i < clipper.DisplayEnd; ++i)
            drawObjectRow(state, report, size_t(i));
    ImGui::EndTable();
}

void drawLightsTab(ViewState& state, const ViewReport& report)
{
    if (!report.scene)
        return;
    drawEnvironment(state, report);
    const float third = (ImGui::GetContentRegionAvail().x - 2.0f * ImGui::GetStyle().ItemSpacing.x) / 3.0f;
    const char* const names[] = {"Add sun", "Add point", "Add spot"};
    for (int type = 0; type < 3; ++type) {
        if (type > 0)
            ImGui::SameLine();
        if (ImGui::Button(names[type], {third, 0})) {
            const Bounds& bounds = report.scene->bounds;
            scene::Light light;
            light.type = scene::LightType(type);
            light.position = bounds.centre() + glm::vec3(0.0f, bounds.radius(), 0.0f);
            light.direction = {0.0f, -1.0f, 0.0f};
            light.intensity = type == 0 ? 1.0f : bounds.radius() * bounds.radius();
            state.lights.push_back(light);
            state.lightsEdited = true;
        }
    }
    std::optional<size_t> removed;
    for (size_t i = 0; i < state.lights.size(); ++i) {
        ImGui::PushID(int(i));
        const char* const kinds[] = {"sun", "point", "spot"};
        const std::string title = fmt::format("{} {}###light", kinds[int(state.lights[i].type)], i + 1);
        const auto flags = i < 2 ? ImGuiTreeNodeFlags_DefaultOpen : 0;
        if (ImGui::CollapsingHeader(title.c_str(), flags)) {
            if (drawLight(state.lights[i]))
                state.lightsEdited = true;
            // A scene without lights would get the usual three.
            if (state.lights.size() > 1 && ImGui::Button("Remove"))
                removed = i;
        }
        ImGui::PopID();
    }
    if (removed) {
        state.lights.erase(state.lights.begin() + long(*removed));
        state.lightsEdited = true;
    }
}

} // namespace lumel::ui
