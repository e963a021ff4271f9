#include "commands.h"
#include "core/error.h"
#include "core/file.h"
#include "core/progress.h"
#include "gltf/gltf.h"
#include "renderer/demands.h"
#include "setup.h"
#include <fmt/format.h>
#include <future>
#include <nlohmann/json.hpp>
#include <regex>

namespace lumel {
namespace {

// The file of each frame: `output` itself, or `output` with its %d or %0Nd replaced by the frame's number.
class FrameFiles {
public:
    explicit FrameFiles(const std::filesystem::path& output, int frames) : output_(output)
    {
        const std::string name = output.filename().string();
        const std::regex conversion("%(?:0([1-9]))?d");
        std::smatch match;
        if (std::regex_search(name, match, conversion)) {
            before_ = match.prefix();
            after_ = match.suffix();
            digits_ = match[1].matched ? std::stoi(match[1]) : 1;
            numbered_ = true;
        }
        // A lone % is a character like any other, but with many frames it is more likely a mistake.
        if (std::regex_search(after_, conversion) ||
            (frames > 1 && (numbered_ ? before_ + after_ : name).find('%') != std::string::npos))
            throw Error(fmt::format("{}: write one %d or %04d for the frame's number", output.string()));
    }
    bool numbered() const { return numbered_; }
    std::filesystem::path of(int frame) const
    {
        if (!numbered_)
            return output_;
        return output_.parent_path() / fmt::format("{}{:0{}}{}", before_, frame, digits_, after_);
    }

private:
    std::filesystem::path output_;
    std::string before_, after_;
    int digits_ = 1;
    bool numbered_ = false;
};

std::vector<FrameStats> renderFrames(const ShotArguments& arguments, const Playback& playback,
                                     const FrameFiles& files, Renderer& renderer)
{
    // The reference shows its own progress, sample by sample.
    std::optional<Progress> progress;
    if (arguments.settings.shading != Shading::reference)
        progress.emplace("frames", size_t(arguments.frames));
    std::vector<FrameStats> frames;
    for (int i = 0; i < arguments.frames; ++i) {
        playback.apply(renderer, i);
        frames.push_back(renderer.render(playback.camera(i)));
        if (files.numbered() || i + 1 == arguments.frames)
            writeImage(files.of(i), arguments.output.extension() == ".exr" ? renderer.readRadiance()
                                                                           : renderer.readDisplay());
        if (progress)
            progress->advance(1);
    }
    return frames;
}

// One line: what was rendered, how long it took, how much was lit.
void printSummary(const ShotArguments& arguments, const RunInfo& run, const std::string& cameraName,
                  const std::vector<FrameStats>& frames)
{
    std::string line =
        fmt::format("{}: {} x {}, {}, filter {}, camera {}", arguments.output.string(), run.width, run.height,
                    run.shading, run.filter, cameraName.empty() ? "framed" : cameraName);
    const FrameStats& first = frames.front();
    if (frames.size() == 1) {
        line += fmt::format(", {} lumels lit, {:.0f} ms", first.lumelsLit, first.ms);
    } else {
        double lumels = 0.0, ms = 0.0;
        const auto later = double(frames.size() - 1);
        for (size_t i = 1; i < frames.size(); ++i) {
            lumels += double(frames[i].lumelsLit) / later;
            ms += frames[i].ms / later;
        }
        line +=
            fmt::format(", {} frames ({}): {} lumels lit in {:.0f} ms, then {:.0f} in {:.1f} ms per frame",
                        frames.size(), run.options.at("path"), first.lumelsLit, first.ms, lumels, ms);
    }
    fmt::print("{} on {}\n", line, run.device);
}

} // namespace

void runShot(const ShotArguments& arguments)
{
    const std::string extension = arguments.output.extension().string();
    if (extension != ".png" && extension != ".exr")
        throw Error(fmt::format("{}: unknown picture format; end the name in .png or .exr",
                                arguments.output.string()));
    if (arguments.settings.budgetMs > 0.0 && arguments.settings.shading == Shading::reference)
        throw Error("--budget-ms: the reference has one quality only; leave the budget out");
    const FrameFiles files(arguments.output, arguments.frames);
    checkWritable(files.of(0));
    if (!arguments.stats.empty())
        checkWritable(arguments.stats);
    // The driver takes its time, too.
    auto loading = std::async(std::launch::async, [&] { return scene::loadGltf(arguments.scene); });
    const gpu::Device device(deviceOptions(arguments));
    checkSizes(device, arguments.settings);
    scene::Scene scene = loading.get();
    changeScene(arguments, scene);
    const scene::Camera camera = chooseCamera(arguments, scene).camera;
    const auto materials = scene::bakeMaterials(scene, {.method = arguments.filter,
                                                        .model = arguments.model,
                                                        .lobes = arguments.lobes,
                                                        .useCache = arguments.useCache,
                                                        .threads = arguments.threads,
                                                        .quick = arguments.quick,
                                                        .asked = arguments.asked});
    Renderer renderer(device, scene, materials, arguments.settings);
    const Playback playback(scene, camera, arguments.path);
    playback.apply(renderer, 0);
    ShotArguments exposed = arguments; // all frames as the first
    exposed.settings.exposure = chooseExposure(arguments, scene, renderer, playback.camera(0));
    renderer.setSettings(exposed.settings);
    const std::vector<FrameStats> frames = renderFrames(exposed, playback, files, renderer);
    const RunInfo run = describeRun(exposed, arguments.path, camera, device);
    if (!arguments.stats.empty())
        writeFileAtomically(
            arguments.stats,
            statsJson(run, frames, objectsOf(scene.objects, renderer), renderer.lumelsByTileSize()).dump(1) +
                "\n");
    printSummary(arguments, run, camera.name, frames);
    checkValidation(device);
}

} // namespace lumel
