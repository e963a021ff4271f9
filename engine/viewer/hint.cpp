// The keys to begin with, until somebody has seen them.
#include "core/error.h"
#include "core/file.h"
#include "panels.h"
#include <array>
#include <fstream>
#include <spdlog/spdlog.h>

namespace lumel::ui {
namespace {

namespace fs = std::filesystem;

struct FirstKey {
    const char* keys;
    const char* what;
};
constexpr std::array kFirstKeys{FirstKey{"Left drag", "orbit"}, FirstKey{"X", "compare two pictures"},
                                FirstKey{"V", "debug views"}, FirstKey{"C", "copy as command"},
                                FirstKey{"?", "all keys"}};
constexpr const char* kDismiss = "Esc hides this";

// $XDG_CONFIG_HOME/lumel/viewer.conf, else in ~/.config (XDG Base Directory specification); empty: nowhere.
fs::path configuration()
{
    const char* const xdg = std::getenv("XDG_CONFIG_HOME");
    const char* const home = std::getenv("HOME");
    if (xdg && fs::path(xdg).is_absolute())
        return fs::path(xdg) / "lumel" / "viewer.conf";
    return home && *home ? fs::path(home) / ".config" / "lumel" / "viewer.conf" : fs::path();
}

} // namespace

bool hintWanted()
{
    std::ifstream file(configuration());
    for (std::string line; std::getline(file, line);)
        if (line == "hint = off")
            return false;
    return true;
}

void rememberHint()
{
    const fs::path file = configuration();
    if (file.empty())
        return;
    try {
        std::error_code ignored; // writing says what is wrong
        fs::create_directories(file.parent_path(), ignored);
        writeFileAtomically(file, "hint = off\n");
    } catch (const Error& e) {
        spdlog::warn("{}", e.what());
    }
}

// In the middle above the lower edge, where the picture is wide enough.
void drawHint(const Layout& layout)
{
    const float gap = 18.0f * layout.scale, pad = 10.0f * layout.scale;
    const auto widthOf = [](const char* text) { return ImGui::CalcTextSize(text).x; };
    const float space = widthOf(" ") * 1.5f;
    float width = 2.0f * pad + widthOf(kDismiss);
    for (const FirstKey& key : kFirstKeys)
        width += widthOf(key.keys) + space + widthOf(key.what) + gap;
    if (width > layout.picture.x - 2.0f * pad)
        return;
    const float height = ImGui::GetFontSize() + 2.0f * pad;
    const ImVec2 corner{std::round(0.5f * (layout.picture.x - width)),
                        layout.picture.y - height - 2.0f * pad};
    ImDrawList* list = ImGui::GetBackgroundDrawList();
    list->AddRectFilled(corner, {corner.x + width, corner.y + height}, kShade, 6.0f * layout.scale);
    ImVec2 at{corner.x + pad, corner.y + pad};
    const auto write = [&](const char* text, ImU32 colour, float after) {
        list->AddText(at, colour, text);
        at.x += widthOf(text) + after;
    };
    for (const FirstKey& key : kFirstKeys) {
        write(key.keys, kAccent, space);
        write(key.what, kText, gap);
    }
    write(kDismiss, kFaint, 0.0f);
}

} // namespace lumel::ui
