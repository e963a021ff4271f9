// What a second lobe gains: mean E on levels 1, 2, 3 and 5 of normal maps and of generated ones, summed, for
// one lobe and two, relative to LEAN's (mean Ks, as it is baked); the share of texels above level 0 with a
// second lobe; and seconds.
//   build/bake_lobes [normal.png...]
//   build/bake_lobes --starts 100 bumps
// The latter takes a generated map and compares the search for two lobes with brute force: the best of so
// many random starts a texel, each searched at quadrature nodes for up to 200 evaluations, on a sample of
// texels.
#include "baker/averager.h"
#include "baker/bake.h"
#include "baker/solver.h"
#include "core/decoder_process.h"
#include "core/error.h"
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <random>

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

// Sums of sines, periods of `texels` and up; slopes of up to about 0.25.
baker::Maps bumps(int size, double texels)
{
    const double turn = 6.283185307179586 / texels / 7.0;
    baker::Maps maps;
    maps.height = generated(size, [&](int x, int y) {
        const double u = turn * x, v = turn * y;
        return 0.5 + 0.2 * std::sin(3 * u + std::cos(2 * v)) + 0.15 * std::sin(5 * v - 2 * u) +
               0.1 * std::cos(7 * u + 4 * v);
    });
    maps.heightScale = float(0.25 * 7.0 * texels / 6.283185307179586 / size);
    return maps;
}

std::vector<Named> generatedMaps()
{
    constexpr int kSize = 512;
    constexpr double kTurn = 6.283185307179586 / kSize;
    std::vector<Named> all;
    all.push_back({"bumps", bumps(kSize, 32.0)});
    all.push_back({"fine bumps", bumps(kSize, 8.0)});
    all.emplace_back().name = "V-grooves";
    all[2].maps.normal = Image(kSize, kSize, 3);
    for (int i = 0; i < kSize * kSize; ++i) {
        const glm::vec3 n = glm::normalize(glm::vec3(i % 8 < 4 ? 0.25f : -0.25f, 0.0f, 1.0f));
        for (int c = 0; c < 3; ++c)
            all[2].maps.normal.pixels[size_t(i) * 3 + size_t(c)] = 0.5f * n[c] + 0.5f;
    }
    all.emplace_back().name = "bow tie";
    all[3].maps.normal = Image(1, 1, 3);
    all[3].maps.normal.pixels = {0.5f, 0.5f, 1.0f};
    all[3].maps.anisotropicPower = {40.0f, 4000.0f};
    all[3].maps.tangentRotation = generated(
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

// The average over a texel of level L of a map of constant power, at nodes, and random pairs of lobes.
class BruteForce {
public:
    explicit BruteForce(const baker::Maps& maps) : source_(maps), averager_(source_) {}

    float bestOf(int starts, int level, int x, int y)
    {
        const int size = 1 << level;
        lobes_.resize(size_t(size) * size_t(size));
        members_.clear();
        for (int j = 0; j < size; ++j)
            source_.read(y * size + j, x * size, (x + 1) * size, lobes_, size_t(j) * size_t(size));
        for (size_t i = 0; i < lobes_.size(); ++i)
            members_.push_back({uint32_t(i), 1.0f});
        baker::Cell cell;
        averager_.gather(lobes_, members_, nullptr, false, cell);
        if (cell.uniform)
            return 0.0f;
        baker::NodeSet nodes;
        std::vector<float> weight[3];
        cell.patch.appendTo(nodes, weight, float(1.0 / cell.sum.weight), 1);
        weight[0].resize(nodes.size());
        baker::PairJob job;
        job.energy = 0.0f;
        for (size_t k = 0; k < nodes.size(); ++k) {
            const float g = weight[0][k];
            weight[0][k] *= nodes.area[k];
            job.energy += g * weight[0][k];
        }
        job.nodes = {int(nodes.size()), nodes.x.data(), nodes.y.data(), nodes.z.data(), weight[0].data()};
        job.area = nodes.area.data();
        job.maxLog = float(0.5 * std::log(1.1 * cell.sum.maxPower - double(baker::kBase)));
        return search(job, starts);
    }

private:
    float search(baker::PairJob job, int starts)
    {
        std::vector<baker::PairJob> jobs;
        std::vector<baker::PairJob*> order;
        std::uniform_int_distribution<size_t> any(0, lobes_.size() - 1);
        std::uniform_real_distribution<float> logWidth(0.0f, 3.0f); // of the lobe's own variance
        for (int i = 0; i < starts; ++i) {
            for (float* unknowns : job.unknowns) {
                const size_t l = any(random_);
                const float s = lobes_.sxx[l] * std::exp(logWidth(random_));
                baker::toUnknowns({lobes_.nx[l], lobes_.ny[l], s, 0.0f, s}, job.maxLog, unknowns);
            }
            jobs.push_back(job);
        }
        for (baker::PairJob& one : jobs)
            order.push_back(&one);
        baker::SearchSettings settings;
        settings.isotropic = false;
        settings.maxEvaluations = 200;
        settings.tolerance = 1e-4f;
        baker::kernels().minimisePairs(order.data(), starts, settings);
        float best = 1.0f;
        for (const baker::PairJob& one : jobs)
            best = std::min(best, one.error);
        return std::max(best, 0.0f);
    }

    baker::Source source_;
    baker::Averager averager_;
    baker::Lobes lobes_;
    std::vector<baker::Member> members_;
    std::mt19937 random_{1};
};

baker::ReflectanceMips bakeOf(const baker::Maps& maps, baker::Method method, LobeCount lobes)
{
    baker::Options options;
    options.method = method;
    options.lobes = lobes;
    return baker::bake(maps, options);
}

// Evenly spread texels of levels 1, 2, 3 and 5; sums of mean E relative to LEAN's.
void compare(Named& map, int starts)
{
    constexpr int kAcross = 16; // texels of a level
    map.maps.powerConstant = 200.0f;
    map.maps.specularConstant = glm::vec3(1.0f);
    const auto lean = bakeOf(map.maps, baker::Method::lean, LobeCount::one);
    const auto two = bakeOf(map.maps, baker::Method::fit, LobeCount::two);
    BruteForce force(map.maps);
    double sums[3] = {};
    fmt::print("{}, power 200: mean E of LEAN, the search, and the best of {} random starts\n", map.name,
               starts);
    for (const int l : {1, 2, 3, 5}) {
        const baker::Level& level = two.levels[size_t(l)];
        const int across = std::min(level.width, kAcross);
        double means[3] = {};
        for (int i = 0; i < across * across; ++i) {
            const int x = (2 * (i % across) + 1) * level.width / (2 * across);
            const int y = (2 * (i / across) + 1) * level.height / (2 * across);
            means[0] += double(lean.levels[size_t(l)].at(x, y)[baker::kError]);
            means[1] += double(level.at(x, y)[baker::kError]);
            means[2] += double(force.bestOf(starts, l, x, y));
        }
        for (int m = 0; m < 3; ++m)
            sums[m] += means[m] /= across * across;
        fmt::print("level {}: {:.5f} {:.5f} {:.5f}\n", l, means[0], means[1], means[2]);
        std::fflush(stdout);
    }
    fmt::print("E / LEAN: search {:.4f}, best of {}: {:.4f}\n", sums[1] / sums[0], starts, sums[2] / sums[0]);
}

int bruteForce(int starts, const std::string& name)
{
    for (Named& map : generatedMaps())
        if (map.name == name && map.maps.anisotropicPower.x <= 0.0f && starts > 0) {
            compare(map, starts);
            return 0;
        }
    fmt::print(stderr,
               "bake_lobes: --starts takes a number above 0 and bumps, \"fine bumps\" or V-grooves\n");
    return 2;
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
        if (argc == 4 && argv[1] == std::string("--starts"))
            return lumel::bruteForce(std::atoi(argv[2]), argv[3]);
        lumel::run(argc, argv);
        return 0;
    } catch (const lumel::Error& e) {
        fmt::print(stderr, "bake_lobes: {}\n", e.what());
        return 1;
    }
}
