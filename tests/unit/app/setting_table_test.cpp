// Each setting of the table, through all that follows from it.
#include "app/command_line.h"
#include "app/options.h"
#include "app/setup.h"
#include "renderer/setting_text.h"
#include <gtest/gtest.h>
#include <set>
#include <sstream>

namespace lumel {
namespace {

// Texts that the setting's option takes: its names, its word, the ends and the middle of its range.
template<class T>
std::vector<std::string> textsFor(const Setting<T>& setting)
{
    if constexpr (std::is_same_v<T, glm::uvec2>) {
        return {"1x8192", "31x17"};
    } else {
        std::vector<std::string> texts(setting.values.begin(), setting.values.end());
        if constexpr (!detail::kNamed<T>) {
            using Number = typename detail::NumberOf<T>::type;
            for (const double at : {0.0, 0.5, 1.0})
                if (setting.values.empty())
                    texts.push_back(numberText(Number(setting.least + at * (setting.most - setting.least))));
        }
        if (setting.word)
            texts.push_back(setting.word);
        return texts;
    }
}

// The default, shaded in a way that the setting applies to.
template<class T>
Settings defaultsFor(const Setting<T>& setting)
{
    Settings settings;
    while (!appliesTo(setting, settings))
        settings.shading = Shading(int(settings.shading) + 1);
    return settings;
}

Settings parsed(const std::string& command)
{
    std::istringstream in(command);
    std::vector<std::string> words;
    for (std::string word; in >> word;)
        words.push_back(word);
    CommandLine line("lumel", "", "");
    Arguments arguments;
    addCommands(line, arguments);
    EXPECT_EQ(line.parse({words.begin() + 1, words.end()}), "shot") << command;
    return arguments.shot.settings;
}

TEST(SettingTable, ReadsWhatItWrites)
{
    forEachSetting([](const auto& setting) {
        size_t others = 0;
        for (const std::string& text : textsFor(setting)) {
            const auto value = valueFrom(setting, text);
            ASSERT_TRUE(value) << setting.name << " " << text;
            Settings settings;
            others += *value != settings.*setting.member;
            settings.*setting.member = *value;
            const auto again = valueFrom(setting, textOf(setting, settings));
            ASSERT_TRUE(again) << setting.name << " " << textOf(setting, settings);
            EXPECT_EQ(*again == *value, true) << setting.name << " " << text;
        }
        EXPECT_GT(others, 0u) << setting.name;
        for (const char* wrong : {"", "?", "nan", "1e99", "-1e99", "7 "})
            EXPECT_FALSE(valueFrom(setting, wrong)) << setting.name << " " << wrong;
    });
}

TEST(SettingTable, AChangeReachesCommandStatisticsAndRenderer)
{
    forEachSetting([](const auto& setting) {
        for (const std::string& text : textsFor(setting)) {
            const Settings before = defaultsFor(setting);
            SceneArguments changed;
            changed.scene = "/scene.gltf";
            changed.settings = before;
            changed.settings.*setting.member = *valueFrom(setting, text);
            if (changed.settings.*setting.member == before.*setting.member)
                continue;
            EXPECT_NE(changes(before, changed.settings), 0u) << setting.name;
            EXPECT_NE(settingTexts(before), settingTexts(changed.settings)) << setting.name;
            const std::string command = shotCommand(changed, {}, {}, "out.png");
            const bool isDefault = changed.settings.*setting.member == Settings().*setting.member;
            EXPECT_EQ(command.find("--" + std::string(setting.name) + " ") != std::string::npos, !isDefault)
                << command;
            EXPECT_EQ(parsed(command).*setting.member == changed.settings.*setting.member, true) << command;
        }
    });
}

TEST(SettingTable, DescribesEachOnce)
{
    std::set<std::string> names;
    size_t bytes = 0;
    forEachSetting([&](const auto& setting) {
        EXPECT_TRUE(names.insert(setting.name).second) << setting.name;
        EXPECT_NE(setting.invalidates, 0u) << setting.name;
        EXPECT_NE(setting.shadings, 0u) << setting.name;
        EXPECT_NE(std::string(setting.help), "") << setting.name;
        bytes += sizeof(Settings().*setting.member);
    });
    // Padding aside, the fields of the table are all that Settings has.
    EXPECT_GE(bytes + alignof(Settings) + 3 * sizeof(bool), sizeof(Settings))
        << "a field without a descriptor";
}

TEST(SettingTable, TheReferenceKeepsItsSamplesWhenOnlyRealTimeShadingChanges)
{
    Settings a;
    a.shading = Shading::reference;
    Settings b = a;
    b.msaa = 1;
    b.budgetMs = 8.0;
    b.forwardAnisotropy = 4;
    EXPECT_NE(changes(a, b), 0u);
    EXPECT_EQ(changes(applicable(a), applicable(b)), 0u);
    b.exposure = 2.0f;
    EXPECT_EQ(changes(applicable(a), applicable(b)), unsigned(invalidates::display));
    b.view = View::density; // of lumels, whatever the shading
    b.levelOffset = 1.0f;
    EXPECT_EQ(applicable(b).levelOffset, 1.0f);
}

} // namespace
} // namespace lumel
