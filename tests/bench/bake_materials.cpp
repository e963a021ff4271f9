// How long each material of glTF models takes to bake, worst first, and how exact the fits are: seconds a
// megatexel of level 0, the share of threads' time that each step of the bake takes, and the mean of E on
// levels 1, 2, 3 and 5.
//   build/bake_materials [--lobes auto|2] model.gltf...
#include "baker/bake.h"
#include "baker/profile.h"
#include "core/decoder_process.h"
#include "core/error.h"
#include "scene/gltf/gltf.h"
#include "scene/material_maps.h"
#include <algorithm>
#include <chrono>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <numeric>

namespace lumel {
namespace {

using Clock = std::chrono::steady_clock;

using Steps = std::array<double, baker::kStepNames.size()>; // seconds of all threads

struct Row {
    std::string name;
    glm::ivec2 size;
    double seconds;
    std::array<double, 4> errors; // mean E
    Steps steps;
    double megatexels() const { return 1e-6 * size.x * size.y; }
    double rate() const { return seconds / megatexels(); }
    bool isConstant() const { return size == glm::ivec2(1); }
};

double meanError(const baker::Level& level)
{
    double sum = 0.0;
    const size_t count = level.texels.size() / baker::kChannels;
    for (size_t i = 0; i < count; ++i)
        sum += double(level.texels[i * baker::kChannels + baker::kError]);
    return sum / double(count);
}

Row bakeOne(const scene::Scene& scene, const scene::Material& material, baker::Options options)
{
    baker::Profile profile;
    options.profile = &profile;
    const baker::Maps maps = scene::reflectanceMaps(scene, material);
    const auto start = Clock::now();
    const baker::ReflectanceMips mips = baker::bake(maps, options);
    Row row{fmt::format("{}:{}", scene.file.stem().string(), material.name),
            baker::mapSize(maps),
            std::chrono::duration<double>(Clock::now() - start).count(),
            {},
            profile.seconds()};
    constexpr std::array<size_t, 4> kLevels = {1, 2, 3, 5};
    for (size_t i = 0; i < kLevels.size(); ++i)
        if (kLevels[i] < mips.levels.size())
            row.errors[i] = meanError(mips.levels[kLevels[i]]);
    return row;
}

// In percent of their sum.
std::string shares(const Steps& steps)
{
    const double sum = std::max(std::accumulate(steps.begin(), steps.end(), 0.0), 1e-9);
    std::string text;
    for (const double seconds : steps)
        text += fmt::format(" {:3.0f}", 100.0 * seconds / sum);
    return text;
}

void print(std::vector<Row>& rows)
{
    std::ranges::sort(rows, std::greater(), [](const Row& r) { return r.isConstant() ? 0.0 : r.rate(); });
    fmt::print("% of time: {}\n", fmt::join(baker::kStepNames, ", "));
    fmt::print("{:40} {:>11} {:>8} {:>8}  {:39} {}\n", "material", "size", "seconds", "s/Mtexel",
               "mean E, levels 1, 2, 3, 5", "% of time");
    Steps total{};
    double constantSeconds = 0.0;
    int constants = 0;
    for (const Row& r : rows) {
        const auto& e = r.errors;
        if (r.isConstant()) {
            constantSeconds += r.seconds;
            ++constants;
            continue;
        }
        std::ranges::transform(total, r.steps, total.begin(), std::plus());
        fmt::print("{:40} {:>11} {:8.3f} {:>8}  {:.5f} {:.5f} {:.5f} {:.5f} {}\n", r.name.substr(0, 40),
                   fmt::format("{} x {}", r.size.x, r.size.y), r.seconds, fmt::format("{:.2f}", r.rate()),
                   e[0], e[1], e[2], e[3], shares(r.steps));
    }
    fmt::print("{:110} {}\n", "all of these", shares(total));
    fmt::print("{} materials without maps: {:.1f} ms\n", constants, 1e3 * constantSeconds);
}

int run(int argc, char** argv)
{
    baker::Options options;
    std::vector<Row> rows;
    int first = 1;
    if (argc > 2 && argv[1] == std::string("--lobes")) {
        options.lobes = argv[2] == std::string("2") ? baker::LobeCount::two : baker::LobeCount::automatic;
        first = 3;
    }
    for (int i = first; i < argc; ++i) {
        const scene::Scene scene = scene::loadGltf(argv[i]);
        for (const scene::Material& material : scene.materials)
            if (material.bakedFile.empty())
                rows.push_back(bakeOne(scene, material, options));
    }
    print(rows);
    return rows.empty() ? 2 : 0;
}

} // namespace
} // namespace lumel

int main(int argc, char** argv)
{
    try {
        const lumel::DecoderProcess decoder; // before any thread
        return lumel::run(argc, argv);
    } catch (const lumel::Error& e) {
        fmt::print(stderr, "bake_materials: {}\n", e.what());
        return 1;
    }
}
