#include "commands.h"
#include "core/error.h"
#include "core/file.h"
#include "frame.h"
#include <charconv>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace lumel {
namespace {

constexpr const char* kShadingNames[] = {"tsl", "forward", "reference"};
constexpr const char* kFilterNames[] = {"fit", "average", "flat", "height", "toksvig", "lean"};

scene::Camera chooseCamera(const ShotArguments& arguments, const scene::Scene& scene)
{
    const float aspect = float(arguments.settings.size.x) / float(arguments.settings.size.y);
    if (arguments.eye || arguments.target) {
        scene::Camera camera;
        camera.name = "options";
        camera.target = arguments.target.value_or(scene.bounds.centre());
        camera.eye =
            arguments.eye.value_or(camera.target + glm::vec3(0.0f, 0.0f, 3.0f * scene.bounds.radius()));
        camera.yFov = glm::radians(arguments.fovDegrees);
        camera.nearMetres = std::max(1e-4f, 0.001f * scene.bounds.radius());
        if (glm::distance(camera.eye, camera.target) < 1e-9f)
            throw Error("--eye and --target are the same point; move one of them");
        return camera;
    }
    if (arguments.camera.empty())
        return scene.cameras.empty() ? scene::frameBounds(scene.bounds, aspect) : scene.cameras.front();
    std::string known;
    for (const auto& camera : scene.cameras) {
        if (camera.name == arguments.camera)
            return camera;
        known += " " + camera.name;
    }
    size_t index = scene.cameras.size();
    const char* end = arguments.camera.data() + arguments.camera.size();
    const auto parsed = std::from_chars(arguments.camera.data(), end, index);
    if (parsed.ec == std::errc() && parsed.ptr == end && index < scene.cameras.size())
        return scene.cameras[index];
    throw Error(fmt::format("{}: no camera '{}'; it has{}", arguments.scene.string(), arguments.camera,
                            known.empty() ? " none: leave --camera out" : known));
}

} // namespace

void runShot(const ShotArguments& arguments)
{
    const std::string extension = arguments.output.extension().string();
    if (extension != ".png" && extension != ".exr")
        throw Error(fmt::format("{}: unknown picture format; end the name in .png or .exr",
                                arguments.output.string()));
    checkWritable(arguments.output);
    const scene::Scene scene = scene::loadGltf(arguments.scene);
    const scene::Camera camera = chooseCamera(arguments, scene);
    const auto materials = scene::bakeMaterials(scene, {.method = arguments.filter,
                                                        .model = arguments.model,
                                                        .useCache = arguments.useCache,
                                                        .threads = arguments.threads});
    const gpu::Device device(arguments.device);
    Renderer renderer(device, scene, materials, arguments.settings);
    const FrameStats stats = renderer.render(camera);
    writeImage(arguments.output, extension == ".exr" ? renderer.readRadiance() : renderer.readDisplay());
    const RunInfo run{.version = LUMEL_VERSION,
                      .device = device.properties().deviceName.data(),
                      .driver = device.driver(),
                      .scene = arguments.scene.string(),
                      .shading = kShadingNames[size_t(arguments.settings.shading)],
                      .filter = kFilterNames[size_t(arguments.filter)],
                      .width = arguments.settings.size.x,
                      .height = arguments.settings.size.y,
                      .options = {{"camera", camera.name},
                                  {"samples", std::to_string(arguments.settings.samples)},
                                  {"msaa", std::to_string(arguments.settings.msaa)},
                                  {"anisotropy", fmt::format("{}", arguments.settings.anisotropy)},
                                  {"exposure", fmt::format("{}", arguments.settings.exposure)}}};
    if (!arguments.stats.empty())
        writeFileAtomically(arguments.stats, statsJson(run, {stats}).dump(1) + "\n");
    fmt::print("{}: {} x {}, {}, filter {}, camera {}, {} lumels lit, {:.0f} ms on {}\n",
               arguments.output.string(), run.width, run.height, run.shading, run.filter,
               camera.name.empty() ? "framed" : camera.name, stats.lumelsLit, stats.ms, run.device);
    if (!device.validationMessages().empty())
        throw Error(
            fmt::format("Vulkan validation: {} messages; report them", device.validationMessages().size()));
}

} // namespace lumel
