// One small scene, a plate with fine rings under two lights, near (a ring covers many pixels) and far (two
// pixels) in every shading mode; tests/bench/report renders them too. When a picture differs, it, the golden
// and their difference are kept in out/golden/.
#include "core/compare.h"
#include "program.h"
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

struct Case {
    const char* name;
    const char* options; // of `lumel shot`, separated by blanks
};

class Golden : public Program, public ::testing::WithParamInterface<Case> {};

TEST_P(Golden, LooksAsBefore)
{
    const std::string file = std::string(GetParam().name) + ".png";
    std::vector<std::string> arguments{"shot", (fs::path(LUMEL_GOLDENS) / "plate/plate.gltf").string(), "-o",
                                       file};
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
