// The scene's objects and lights.
#include "setting_widgets.h"
#include <fmt/format.h>

namespace lumel::ui {
namespace {

constexpr std::array kLightTypes{"sun", "point", "spot"}; // scene::LightType

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
        ImGui::SetTooltip("shaded forward: %s", problem.c_str());
    ImGui::PopID();
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(lit ? report.residency[i].share < 1.0f ? "fading" : "tsl" : "forward");
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

bool drawPlace(scene::Light& light)
{
    label("Position");
    bool changed = ImGui::DragFloat3("##position", &light.position.x, 0.01f, 0.0f, 0.0f, "%.2f m");
    label("Range");
    changed |= ImGui::DragFloat("##range", &light.range, 0.05f, 0.0f, 1e6f,
                                light.range > 0.0f ? "%.2f m" : "unlimited", ImGuiSliderFlags_AlwaysClamp);
    return changed;
}

bool drawDirection(scene::Light& light)
{
    label("Direction");
    glm::vec3 direction = light.direction;
    if (!ImGui::DragFloat3("##direction", &direction.x, 0.01f, -1.0f, 1.0f, "%.2f") ||
        glm::length(direction) <= 1e-3f)
        return false;
    light.direction = glm::normalize(direction);
    return true;
}

bool drawCone(scene::Light& light)
{
    label("Cone", "inner and outer cone angle, from the axis");
    float degrees[2] = {glm::degrees(light.innerCone), glm::degrees(light.outerCone)};
    if (!ImGui::DragFloat2("##cone", degrees, 0.2f, 0.0f, 90.0f, "%.0f degrees"))
        return false;
    degrees[1] = std::clamp(degrees[1], 1.0f, 90.0f);
    light.innerCone = glm::radians(std::clamp(degrees[0], 0.0f, degrees[1] - 0.5f));
    light.outerCone = glm::radians(degrees[1]);
    return true;
}

bool drawLight(scene::Light& light)
{
    using enum scene::LightType;
    bool changed = combo("Type", "##type", light.type, kLightTypes);
    label("Colour");
    changed |= ImGui::ColorEdit3("##colour", &light.colour.x, ImGuiColorEditFlags_Float);
    label("Intensity");
    changed |= ImGui::DragFloat("##intensity", &light.intensity, 0.01f * std::max(light.intensity, 0.1f),
                                0.0f, 1e6f, light.type == directional ? "%.3g lux" : "%.3g candela",
                                ImGuiSliderFlags_AlwaysClamp);
    if (light.type != directional)
        changed |= drawPlace(light);
    if (light.type != point)
        changed |= drawDirection(light);
    if (light.type == spot)
        changed |= drawCone(light);
    return changed;
}

void drawAmbient(Settings& s, const ViewReport& report)
{
    label("Ambient", "radiance of a uniform sky beside the environment; right click: default");
    float ambient = s.ambient.value_or(report.ambient);
    if (ImGui::SliderFloat("##ambient", &ambient, 0.0f, 100.0f, s.ambient ? "%.3g" : "%.3g (default)",
                           ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_AlwaysClamp))
        s.ambient = ambient;
    if (ImGui::IsItemClicked(ImGuiMouseButton_Right))
        s.ambient.reset();
}

void drawEnvironment(ViewState& state, const ViewReport& report)
{
    label("Environment", "drop an equirectangular map on the window");
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
    if (state.environment != "none")
        drawSettings(state, Panel::environment);
    drawAmbient(state.settings, report);
    drawSettings(state, Panel::lights);
    ImGui::Separator();
}

} // namespace

void drawObjectsTab(ViewState& state, const ViewReport& report)
{
    if (!report.scene)
        return;
    ImGui::TextDisabled("%zu objects. Click one here or in the picture.", report.scene->objects.size());
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
        const std::string title =
            fmt::format("{} {}###light", kLightTypes[size_t(state.lights[i].type)], i + 1);
        const auto flags = i < 2 ? ImGuiTreeNodeFlags_DefaultOpen : 0;
        if (ImGui::CollapsingHeader(title.c_str(), flags)) {
            if (drawLight(state.lights[i]))
                state.lightsEdited = true;
            // A scene without lights would get the default three.
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
