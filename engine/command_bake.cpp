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

} // namespace

void runBake(const BakeArguments& arguments)
{
    const auto start = std::chrono::steady_clock::now();
    checkWritable(arguments.output);
    baker::Maps maps;
    maps.height = readIfNamed(arguments.height);
    maps.heightScale = arguments.heightScale;
    maps.normal = readIfNamed(arguments.normal);
    maps.normalGreenUp = arguments.normalGreen == "up";
    maps.wrap = arguments.wrap;
    maps.power = readIfNamed(arguments.powerMap);
    maps.powerConstant = arguments.power;
    maps.roughness = readIfNamed(arguments.roughness);
    maps.tangentRotation = readIfNamed(arguments.tangentRotation);
    readColourOption(arguments.specular, maps.specularConstant, maps.specular);
    readColourOption(arguments.diffuse, maps.diffuseConstant, maps.diffuse);

    baker::ReflectanceMips mips;
    {
        Progress progress("bake " + arguments.output.filename().string(), baker::progressUnits(maps));
        mips = baker::bake(maps, arguments.options, &progress);
    }
    baker::writeExr(arguments.output, mips, arguments.asFloat);
    const auto& base = mips.levels.front();
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    fmt::print("{}: {} x {}, {} levels, {} {}, {:.2f} s\n", arguments.output.string(), base.width,
               base.height, mips.levels.size(), mips.method, mips.model, seconds);
}

} // namespace lumel
