#include "setting_widgets.h"
#include "renderer/setting_text.h"
#include <algorithm>

namespace lumel::ui {
namespace {

bool appliesToASide(const auto& setting, const ViewState& state)
{
    Settings settings = state.settings;
    for (size_t side = 0; side < (state.split ? 2u : 1u); ++side) {
        settings.shading = state.sides[side].shading;
        if (appliesTo(setting, settings))
            return true;
    }
    return false;
}

template<class T>
void drawChoice(const Setting<T>& setting, Settings& s)
{
    const auto names = setting.values;
    const std::string now = textOf(setting, s);
    int index = int(std::ranges::find(names, now) - names.begin());
    if (ImGui::Combo("##value", &index, names.data(), int(names.size())))
        s.*setting.member = *valueFrom(setting, names[size_t(index)]);
}

// The end of the slider that is nearer to the value of the setting's word stands for the word.
template<class T>
void drawSlider(const Setting<T>& setting, Settings& s)
{
    const Widget& w = setting.widget;
    const double scale = double(w.scale) / setting.memberPerUnit;
    T& value = s.*setting.member;
    const bool wordIsMost = double(setting.wordValue) * scale > w.most;
    const bool isWord = setting.word && value == setting.wordValue;
    float shown = isWord ? (wordIsMost ? w.most : w.least) : float(double(value) * scale);
    const auto flags = ImGuiSliderFlags_AlwaysClamp | (w.logarithmic ? ImGuiSliderFlags_Logarithmic : 0);
    if (!ImGui::SliderFloat("##value", &shown, w.least, w.most, isWord ? setting.word : w.format, flags))
        return;
    const bool atWord = setting.word && (wordIsMost ? shown >= 0.99f * w.most : shown <= w.least);
    value = atWord ? setting.wordValue : T(double(shown) / scale);
}

template<class T>
void drawWidget(const Setting<T>& setting, Settings& s)
{
    label(setting.widget.label, setting.help);
    if constexpr (std::is_same_v<T, bool>)
        ImGui::Checkbox("##value", &(s.*setting.member));
    else if constexpr (std::is_enum_v<T>)
        drawChoice(setting, s);
    else if constexpr (std::is_arithmetic_v<T>)
        setting.values.empty() ? drawSlider(setting, s) : drawChoice(setting, s);
}

} // namespace

void drawSettings(ViewState& state, Panel panel)
{
    forEachSetting([&](const auto& setting) {
        if (setting.widget.panel != panel)
            return;
        ImGui::PushID(setting.name);
        ImGui::BeginDisabled(!appliesToASide(setting, state));
        drawWidget(setting, state.settings);
        ImGui::EndDisabled();
        ImGui::PopID();
    });
}

} // namespace lumel::ui
