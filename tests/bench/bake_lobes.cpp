// What a second lobe gains: mean E on levels 1, 2, 3 and 5 of normal maps and of generated ones, summed, for
// one lobe and two, relative to LEAN's (mean Ks, as it is baked); the share of texels above level 0 with a
// second lobe; and seconds.
//   build/bake_lobes [normal.png...]
#include "baker/bake.h"
#include "core/decoder_process.h"
#include "core/error.h"
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>

namespace lumel {
namespace {

using baker::LobeCount;
using Clock = std::chrono::steady_clock;

struct Named {
    std::string name;
    baker::Maps maps;
};

template<class Value>
Image generated(int size, const Value& value)
{
    Image image(size, size, 1);
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x)
            *image.at(x, y) = float(value(x, y));
    return image;
}

// Slopes of up to about 0.25 for the bumps, of 0.25 for the grooves.
std::vector<Named> generatedMaps()
{
    constexpr int kSize = 512;
    constexpr double kTurn = 6.283185307179586 / kSize;
    std::vector<Named> all(3);
    all[0].name = "bumps";
    all[0].maps.height = generated(kSize, [](int x, int y) {
        const double u = kTurn * x, v = kTurn * y;
        return 0.5 + 0.2 * std::sin(37 * u + std::cos(22 * v)) + 0.15 * std::sin(59 * v - 23 * u) +
               0.1 * std::cos(71 * u + 43 * v);
    });
    all[0].maps.heightScale = 0.004f;
    all[1].name = "V-grooves";
    all[1].maps.normal = Image(kSize, kSize, 3);
    for (int i = 0; i < kSize * kSize; ++i) {
        const glm::vec3 n = glm::normalize(glm::vec3(i % 8 < 4 ? 0.25f : -0.25f, 0.0f, 1.0f));
        for (int c = 0; c < 3; ++c)
            all[1].maps.normal.pixels[size_t(i) * 3 + size_t(c)] = 0.5f * n[c] + 0.5f;
    }
    all[2].name = "bow tie";
    all[2].maps.normal = Image(1, 1, 3);
    all[2].maps.normal.pixels = {0.5f, 0.5f, 1.0f};
    all[2].maps.anisotropicPower = {40.0f, 4000.0f};
    all[2].maps.tangentRotation = generated(
        kSize, [](int x, int y) { return 0.25 + 0.2 * std::sin(kTurn * 61 * x) * std::cos(kTurn * 47 * y); });
    return all;
}

struct Result {
    double error = 0.0, seconds = 0.0, share = 0.0;
};

Result bake(const baker::Maps& maps, baker::Method method, LobeCount lobes)
{
    baker::Options options;
    options.method = method;
    options.lobes = lobes;
    const auto start = Clock::now();
    const baker::ReflectanceMips mips = baker::bake(maps, options);
    Result result;
    result.seconds = std::chrono::duration<double>(Clock::now() - start).count();
    size_t texels = 0, seconds = 0;
    for (size_t l = 1; l < mips.levels.size(); ++l) {
        const baker::Level& level = mips.levels[l];
        const size_t count = size_t(level.width) * size_t(level.height);
        double sum = 0.0;
        for (size_t i = 0; i < count; ++i) {
            sum += double(level.texels[i * baker::kChannels + baker::kError]);
            if (!level.second.empty())
                seconds += level.second[i * baker::kSecondChannels + baker::kKs2G] > 0.0f;
        }
        texels += count;
        if (l <= 3 || l == 5)
            result.error += sum / double(count);
    }
    result.share = double(seconds) / double(std::max<size_t>(texels, 1));
    return result;
}

void measure(Named& map, float power)
{
    map.maps.powerConstant = power;
    map.maps.specularConstant = glm::vec3(1.0f);
    using baker::Method;
    const Result lean = bake(map.maps, Method::lean, LobeCount::one);
    const Result one = bake(map.maps, Method::fit, LobeCount::one);
    const Result some = bake(map.maps, Method::fit, LobeCount::automatic);
    const Result two = bake(map.maps, Method::fit, LobeCount::two);
    fmt::print("{:24} {:5} {:7.4f} {:6.3f} {:6.3f} {:6.3f} {:4.0f} % {:4.0f} % {:6.2f} {:6.2f} {:6.2f}\n",
               map.name, power, lean.error, one.error / lean.error, some.error / lean.error,
               two.error / lean.error, 100.0 * some.share, 100.0 * two.share, one.seconds, some.seconds,
               two.seconds);
    std::fflush(stdout);
}

void run(int argc, char** argv)
{
    std::vector<Named> maps;
    for (int i = 1; i < argc; ++i) {
        const std::filesystem::path file = argv[i];
        maps.emplace_back();
        maps.back().name = (file.parent_path().filename() / file.stem()).string();
        maps.back().name.resize(std::min<size_t>(maps.back().name.size(), 24));
        maps.back().maps.normal = readImage(file);
    }
    for (Named& map : generatedMaps())
        maps.push_back(std::move(map));
    fmt::print("{:24} {:>5} {:>7} {:>6} {:>6} {:>6} {:>6} {:>6} {:>6} {:>6} {:>6}\n", "map", "power", "LEAN",
               "one", "auto", "two", "share", "share", "s one", "s auto", "s two");
    for (const float power : {200.0f, 1000.0f})
        for (Named& map : maps)
            if (map.maps.anisotropicPower.x <= 0.0f || power == 200.0f) // that one has powers of its own
                measure(map, power);
}

} // namespace
} // namespace lumel

int main(int argc, char** argv)
{
    try {
        const lumel::DecoderProcess decoder; // before any thread
        lumel::run(argc, argv);
        return 0;
    } catch (const lumel::Error& e) {
        fmt::print(stderr, "bake_lobes: {}\n", e.what());
        return 1;
    }
}
