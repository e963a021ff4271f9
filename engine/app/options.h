// The command line: each function adds one command, or what several share, and fills plain data.
#pragma once
#include "commands.h"
#include "option_parser.h"

namespace lumel {

// What all commands are given; only those of the command that was named count.
struct Arguments {
    BakeArguments bake;
    ExportArguments exported;
    ShotArguments shot;
    ViewArguments view;
    CompareArguments compare;
    BenchArguments bench;
    HelpArguments help;
};

// `arguments` must outlive parsing.
void addCommands(CommandLine& line, Arguments& arguments);

void addBake(CommandLine& line, BakeArguments& arguments);
void addExport(CommandLine& line, ExportArguments& arguments);
Option addExportFormat(Command& command, ExportChoices& choices); // --to
void addShot(CommandLine& line, ShotArguments& arguments);
void addView(CommandLine& line, ViewArguments& arguments);
void addCompare(CommandLine& line, CompareArguments& arguments);
void addBench(CommandLine& line, BenchArguments& arguments);
void addHelp(CommandLine& line, HelpArguments& arguments);

// What is rendered, from where and how: the same for every command that renders.
void addSceneOptions(Command& command, SceneArguments& arguments);
void addQuick(Command& command, SceneArguments& arguments);
void addPathOptions(Command& command, PathOptions& path);
void checkPath(const PathOptions& path); // after parsing; throws UsageError
inline constexpr const char* kLobesHelp =
    "lobes of a texel; auto: a second one where it lowers the error by a quarter and by 0.005";
inline constexpr const char* kFilterHelp =
    "how MIP levels of the reflectance are made: fitted to the "
    "average, or average, flat, height, toksvig or lean; fit-power keeps the average normal";

} // namespace lumel
