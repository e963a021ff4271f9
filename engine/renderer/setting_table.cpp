#include "setting_table.h"

namespace lumel {

unsigned changes(const Settings& before, const Settings& after)
{
    unsigned changed = 0;
    forEachSetting([&](const auto& setting) {
        if (before.*setting.member != after.*setting.member)
            changed |= setting.invalidates;
    });
    return changed;
}

Settings applicable(const Settings& settings)
{
    Settings result;
    forEachSetting([&](const auto& setting) {
        if (appliesTo(setting, settings))
            result.*setting.member = settings.*setting.member;
    });
    return result;
}

} // namespace lumel
