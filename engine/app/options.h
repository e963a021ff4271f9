// The commands' options: each function adds one command, or what several share, and fills plain data.
#pragma once
#include "commands.h"
#include <CLI/CLI.hpp>

namespace lumel {

void addBake(CLI::App& app, BakeArguments& arguments);
void addShot(CLI::App& app, ShotArguments& arguments);
void addView(CLI::App& app, ViewArguments& arguments);
void addCompare(CLI::App& app, CompareArguments& arguments);
void addBench(CLI::App& app, BenchArguments& arguments);

// What is rendered, from where and how: the same for every command that renders.
void addSceneOptions(CLI::App* command, SceneArguments& arguments);
void addPathOptions(CLI::App* command, PathOptions& path);
void checkPath(const PathOptions& path); // after parsing; throws CLI::ValidationError
// "960x540" to two numbers; returns what is wrong with the text, nothing if it is right.
std::string parseSize(const std::string& text, glm::uvec2& size);

// Names that several commands take.
extern const std::map<std::string, baker::Method> kMethods;
extern const std::map<std::string, baker::Model> kModels;
extern const std::map<std::string, scene::Path> kPaths;
inline constexpr const char* kMethodHelp =
    "how coarser texels are made: fit, average, flat, height, toksvig or lean";

} // namespace lumel
