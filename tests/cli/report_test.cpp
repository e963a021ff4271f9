// tests/bench/report without a device: a program that fails at everything.
#include "program.h"
#include <cstdlib>
#include <nlohmann/json.hpp>

namespace lumel::cli {
namespace {

class DeviceReport : public Program {
protected:
    // Its exit status, with this shell script in place of lumel.
    int report(const std::string& script)
    {
        writeText(folder_ / "lumel", "#!/bin/sh\n" + script);
        std::filesystem::permissions(folder_ / "lumel", std::filesystem::perms::owner_all);
        const std::string command =
            "cd " + folder_.string() + " && " LUMEL_REPORT " --lumel ./lumel -o out >stdout 2>stderr";
        const int status = std::system(command.c_str());
        return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    }
};

TEST_F(DeviceReport, NamesTheStepThatFailsAndKeepsTheOthers)
{
    EXPECT_EQ(report("test \"$1\" = --version && echo 9.9 || { echo no ink >&2; exit 3; }\n"), 1);
    const auto data = nlohmann::json::parse(readText(folder_ / "out/report.json"));
    EXPECT_EQ(data.at("versions").at("lumel"), "9.9");
    const auto& steps = data.at("steps");
    ASSERT_GE(steps.size(), 4u);
    EXPECT_EQ(steps[1].at("state"), "failed") << steps;
    EXPECT_EQ(steps[1].at("reason"), "no ink (status 3)") << steps;
    EXPECT_EQ(steps.back().at("state"), "skipped") << steps;
    const std::string page = readText(folder_ / "out/report.md");
    EXPECT_NE(page.find("measure**: failed: no ink (status 3)."), std::string::npos) << page;
    EXPECT_EQ(page.find("## "), std::string::npos) << page;
}

TEST_F(DeviceReport, ThatCannotStartIsOneLineAndLeavesNothing)
{
    const std::string command =
        "cd " + folder_.string() + " && " LUMEL_REPORT " --lumel ./none -o out 2>stderr";
    EXPECT_NE(std::system(command.c_str()), 0);
    EXPECT_NE(readText(folder_ / "stderr").find("./none is missing"), std::string::npos);
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
}

} // namespace
} // namespace lumel::cli
