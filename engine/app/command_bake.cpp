#include "baker/footprint.h"
#include "baker/manifest.h"
#include "baker/report.h"
#include "commands.h"
#include "core/error.h"
#include "core/file.h"
#include <charconv>
#include <chrono>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

namespace lumel {
namespace {

// "0.5" or "1,0.8,0.3" as a colour; nullopt when the text is not made of numbers.
std::optional<glm::vec3> parseColour(const std::string& text)
{
    std::vector<float> values;
    const char* at = text.data();
    const char* end = at + text.size();
    while (at <= end) {
        float value = 0.0f;
        const auto [next, error] = std::from_chars(at, end, value);
        if (error != std::errc() || (next != end && *next != ','))
            return std::nullopt;
        values.push_back(value);
        at = next + 1;
    }
    if (values.size() == 1)
        return glm::vec3(values[0]);
    if (values.size() == 3)
        return glm::vec3(values[0], values[1], values[2]);
    return std::nullopt;
}

// Constant or image, by what the option's text is.
void readColourOption(const std::string& text, glm::vec3& constant, Image& image)
{
    if (const auto colour = parseColour(text))
        constant = *colour;
    else
        image = readImage(text);
}

Image readIfNamed(const std::filesystem::path& file)
{
    return file.empty() ? Image() : readImage(file);
}

void runManifest(const BakeArguments& arguments)
{
    const baker::ManifestResult result =
        baker::bakeManifest(arguments.manifest, arguments.options, true, arguments.shard);
    if (result.failures.empty())
        return;
    std::string names; // a failure is "output: why"
    for (const std::string& failure : result.failures)
        names += (names.empty() ? "" : ", ") + failure.substr(0, failure.find(": "));
    throw Error(fmt::format("{}: {} of {} maps failed: {}", arguments.manifest.string(),
                            result.failures.size(), result.failures.size() + result.baked + result.upToDate,
                            names));
}

void exportBaked(const BakeArguments& arguments, const baker::ReflectanceMips& mips, Progress& progress)
{
    baker::StagedFiles files(arguments.exportFolder);
    const std::string remark =
        baker::exportMips({.name = arguments.output.stem().string(),
                           .bakedFile = arguments.output.filename().string(),
                           .mips = mips},
                          exportOptions(arguments.exported, arguments.options.threads), files);
    files.publish();
    if (!remark.empty())
        progress.print(remark);
}

} // namespace

void runBake(const BakeArguments& arguments)
{
    if (!arguments.manifest.empty())
        return runManifest(arguments);
    if (!arguments.model.empty())
        return runBakeModel(arguments);
    const auto start = std::chrono::steady_clock::now();
    checkWritable(arguments.output);
    for (const auto& file : arguments.reports)
        checkWritable(file);
    baker::Maps maps;
    maps.height = readIfNamed(arguments.height);
    maps.heightScale = arguments.heightScale;
    maps.normal = readIfNamed(arguments.normal);
    maps.normalGreenUp = arguments.normalGreenUp;
    maps.wrap = arguments.wrap;
    maps.power = readIfNamed(arguments.powerMap);
    maps.powerConstant = arguments.power;
    if (arguments.anisotropicPower.size() == 2)
        maps.anisotropicPower = {arguments.anisotropicPower[0], arguments.anisotropicPower[1]};
    maps.roughness = readIfNamed(arguments.roughness);
    maps.tangentRotation = readIfNamed(arguments.tangentRotation);
    readColourOption(arguments.specular, maps.specularConstant, maps.specular);
    readColourOption(arguments.diffuse, maps.diffuseConstant, maps.diffuse);

    const auto secondsSince = [](std::chrono::steady_clock::time_point from) {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - from).count();
    };
    const std::string name = arguments.output.filename().string();
    Progress progress("bake " + name,
                      baker::progressUnits(maps) +
                          (arguments.reports.empty() ? 0 : baker::measureUnits(maps, arguments.options)));
    const auto bakeStart = std::chrono::steady_clock::now();
    // Only a report and an export need the levels after they are written.
    const bool keeps = !arguments.reports.empty() || !arguments.exportFolder.empty();
    const baker::ReflectanceMips mips =
        keeps ? baker::bake(maps, arguments.options, &progress)
              : baker::bakeExr(arguments.output, maps, arguments.options, arguments.asFloat, &progress);
    const double bakeSeconds = secondsSince(bakeStart);
    if (keeps)
        baker::writeExr(arguments.output, mips, arguments.asFloat);
    const glm::ivec2 size = baker::mapSize(maps);
    const int reduce = arguments.options.reduce;
    progress.print(fmt::format("{}: {} x {}, {} levels, {} {}, {:.2f} s", arguments.output.string(),
                               baker::levelSize(size.x, reduce), baker::levelSize(size.y, reduce),
                               baker::levelCount(size.x, size.y) - reduce, mips.method, mips.model,
                               secondsSince(start)));
    if (!arguments.exportFolder.empty())
        exportBaked(arguments, mips, progress);
    if (arguments.reports.empty())
        return;
    baker::Report report = baker::makeReport(maps, arguments.options, mips, bakeSeconds, &progress);
    report.name = name;
    for (const auto& file : arguments.reports)
        baker::writeReport(file, report);
}

} // namespace lumel
