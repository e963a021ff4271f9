#include "bench/compare_runs.h"
#include "bench/floors.h"
#include "bench/plot.h"
#include "bench_runner.h"
#include "core/canvas.h"
#include "core/error.h"
#include "core/file.h"
#include "example_scenes.h"
#include "renderer/demands.h"
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace lumel {
namespace {

bool compare(const BenchArguments& arguments)
{
    const auto ratios =
        bench::compareRuns(bench::readRuns(arguments.compare[0]), bench::readRuns(arguments.compare[1]));
    fmt::print("{}", bench::tableOf(ratios));
    const double worst = bench::worstOf(ratios);
    if (!arguments.limit || worst <= *arguments.limit)
        return true;
    fmt::print("slower than the limit: {:.3f} > {:g}\n", worst, *arguments.limit);
    return false;
}

// Fails before hours of measuring, not after.
void checkOutputs(const BenchArguments& arguments)
{
    for (const auto& file : {arguments.json, arguments.csv, arguments.plot})
        if (!file.empty())
            checkWritable(file);
    if (arguments.plot.empty())
        return;
    if (arguments.plot.extension() != ".png")
        throw Error(fmt::format("{}: plots are PNG; end the name in .png", arguments.plot.string()));
    const Canvas fontIsThere(1, 1, glm::vec3(0.0f));
}

} // namespace

bool runBench(const BenchArguments& given)
{
    if (!given.compare.empty())
        return compare(given);
    BenchArguments arguments = given;
    if (arguments.scenes.empty())
        arguments.scenes.push_back(std::filesystem::relative(exampleScene("stress")));
    checkOutputs(arguments);
    const gpu::Device device(deviceOptions(arguments));
    BenchRunner runner(device, arguments);
    runner.measure();
    const nlohmann::json document = runner.document();
    const std::vector<bench::Run> runs = bench::runsOf(document);
    fmt::print("{}, {}\n{}{}", device.properties().deviceName.data(), device.driver(), bench::tableOf(runs),
               bench::floorTables(document));
    if (!arguments.json.empty())
        writeFileAtomically(arguments.json, document.dump(1) + "\n");
    if (!arguments.csv.empty())
        writeFileAtomically(arguments.csv, bench::csvOf(runs));
    if (!arguments.plot.empty())
        writeImage(arguments.plot, bench::plotRuns(runs));
    checkValidation(device);
    return true;
}

} // namespace lumel
