// The widgets of the settings that setting_table.h puts on a panel.
#pragma once
#include "panels.h"
#include "renderer/setting_table.h"

namespace lumel::ui {

template<class Enum, size_t count>
bool combo(const char* name, const char* id, Enum& value, const std::array<const char*, count>& names)
{
    label(name);
    int index = int(value);
    const bool changed = ImGui::Combo(id, &index, names.data(), int(count));
    value = Enum(index);
    return changed;
}

// Disabled where no side's picture depends on them.
void drawSettings(ViewState& state, Panel panel);

} // namespace lumel::ui
