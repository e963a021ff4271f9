// One small scene, a plate with fine rings under two lights, near (a ring covers many pixels) and far (two
// pixels) in every shading mode. When a picture differs, it, the golden and their difference are kept in
// out/golden/.
#include "core/compare.h"
#include "inputs.h"
#include "program.h"
#include <cmath>
#include <cstdlib>
#include <fmt/format.h>
#include <sstream>

namespace lumel::cli {
namespace {

namespace fs = std::filesystem;

// The goldens come from Mesa's lavapipe, whose device name this is. The same device gives the same bytes;
// other devices and drivers round differently along edges. For comparison: forward and texture space differ
// by 42 dB near and 40 dB far.
constexpr const char* kGoldenDevice = "llvmpipe";
constexpr double kLeastPsnr = 45.0;

void writeRings(const fs::path& file)
{
    constexpr int kSize = 128;
    Image image(kSize, kSize, 1);
    for (int y = 0; y < kSize; ++y)
        for (int x = 0; x < kSize; ++x) {
            const float r = std::hypot(float(x) - 63.5f, float(y) - 63.5f);
            const bool gap = std::fmod(r, 22.0f) < 5.0f; // as between the tracks of a record
            *image.at(x, y) = gap ? 0.5f : 0.5f + 0.5f * std::cos(r);
        }
    writeImage(file, image);
}

void writePlate(const fs::path& gltf)
{
    nlohmann::json document = squareScene(gltf);
    writeRings(gltf.parent_path() / document["images"][0]["uri"].get<std::string>());
    auto& material = document["materials"][0];
    material["pbrMetallicRoughness"] = {
        {"baseColorFactor", {0.06, 0.015, 0.01, 1.0}}, {"metallicFactor", 0.0}, {"roughnessFactor", 0.32}};
    material["extras"]["lumel"]["heightScale"] = 0.006; // slopes up to 0.38
    document["extensionsUsed"] = nlohmann::json::array({"KHR_lights_punctual"});
    auto& lights = document["extensions"]["KHR_lights_punctual"]["lights"];
    // Quaternions that turn -Z towards (0.5, -0.3, -0.8) and (-0.6, 0.1, -0.8), nearly.
    const double turns[2][4] = {{-0.13, -0.27, 0.04, 0.95}, {0.05, 0.32, 0.02, 0.95}};
    for (int i = 0; i < 2; ++i) {
        const double length =
            std::hypot(std::hypot(turns[i][0], turns[i][1]), std::hypot(turns[i][2], turns[i][3]));
        lights.push_back({{"type", "directional"},
                          {"intensity", i == 0 ? 4.0 : 2.5},
                          {"color", {1.0, 0.8, 0.6 + 0.4 * i}}});
        document["nodes"].push_back(
            {{"rotation",
              {turns[i][0] / length, turns[i][1] / length, turns[i][2] / length, turns[i][3] / length}},
             {"extensions", {{"KHR_lights_punctual", {{"light", i}}}}}});
        document["scenes"][0]["nodes"].push_back(i + 1);
    }
    writeScene(gltf, document);
}

struct Case {
    const char* name;
    const char* options; // of `lumel shot`, separated by blanks
};

class Golden : public Program, public ::testing::WithParamInterface<Case> {};

TEST_P(Golden, LooksAsBefore)
{
    writePlate(folder_ / "plate.gltf");
    const std::string file = std::string(GetParam().name) + ".png";
    std::vector<std::string> arguments{"shot", "plate.gltf", "-o", file};
    std::istringstream options(GetParam().options);
    for (std::string option; options >> option;)
        arguments.push_back(option);
    const Outcome outcome = run(arguments);
    ASSERT_EQ(outcome.exitCode, 0) << outcome.err;

    const fs::path golden = fs::path(LUMEL_GOLDENS) / file, failures = LUMEL_GOLDEN_FAILURES;
    const auto keep = [&](const fs::path& from, const fs::path& to) {
        fs::create_directories(to.parent_path());
        fs::copy_file(from, to, fs::copy_options::overwrite_existing);
    };
    if (const char* update = std::getenv("LUMEL_UPDATE_GOLDENS"); update && *update) {
        ASSERT_NE(outcome.out.find(kGoldenDevice), std::string::npos)
            << "goldens are made on " << kGoldenDevice << ", not elsewhere: " << outcome.out;
        keep(folder_ / file, golden);
        return;
    }
    ASSERT_TRUE(fs::exists(golden)) << "no golden picture yet; look at the result, then ./run test --update";
    const Image now = readDisplayImage(folder_ / file), before = readDisplayImage(golden);
    const Comparison difference = compareImages(now, before);
    if (difference.psnr >= kLeastPsnr)
        return;
    keep(folder_ / file, failures / file);
    keep(golden, failures / fmt::format("{}-golden.png", GetParam().name));
    writeImage(failures / fmt::format("{}-difference.png", GetParam().name), differenceImage(now, before));
    ADD_FAILURE() << fmt::format("{}: {:.1f} dB, at least {} wanted; see {}, accept with ./run test --update",
                                 file, difference.psnr, kLeastPsnr, failures.string());
}

#define NEAR "--size 192x108 --fov 40 --eye 0.3,-1.1,0.7 --target 0,-0.2,0 "
#define FAR "--size 96x64 --fov 26 --eye 1.5,-6,7 --target 0,0,0 "

INSTANTIATE_TEST_SUITE_P(Plate, Golden,
                         ::testing::Values(Case{"near-tsl", NEAR "--shading tsl"},
                                           Case{"near-forward", NEAR "--shading forward"},
                                           Case{"near-reference", NEAR "--shading reference --samples 16"},
                                           Case{"far-tsl", FAR "--shading tsl"},
                                           Case{"far-forward", FAR "--shading forward"},
                                           Case{"far-average", FAR "--shading forward --filter average"},
                                           Case{"far-reference", FAR "--shading reference --samples 64"}),
                         [](const auto& info) {
                             std::string name = info.param.name;
                             name[name.find('-')] = '_';
                             return name;
                         });

} // namespace
} // namespace lumel::cli
