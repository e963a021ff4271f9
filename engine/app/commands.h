// The commands behind main(): options as plain data in, exit through Error or return.
#pragma once
#include "baker/bake.h"
#include "baker/manifest.h"
#include "export/export.h"
#include "gpu/device.h"
#include "gpu/present_mode.h"
#include "playback.h"
#include "renderer/settings.h"
#include "scene/materials.h"
#include <filesystem>
#include <optional>
#include <string>

namespace lumel {

// auto follows the format of the files.
enum class PackingChoice { automatic, gltf, orm, unity, unreal };
enum class TexelChoice { automatic, bytes, blocks, halves };

// How a baked material is written for other engines.
struct ExportChoices {
    baker::ExportFormat format = baker::ExportFormat::ktx2;
    PackingChoice packing = PackingChoice::automatic;
    TexelChoice texels = TexelChoice::automatic;
    bool normalGreenUp = true;
    bool anisotropic = false;
    baker::DdsHeader ddsHeader = baker::DdsHeader::dx10;
    bool zstandard = false;
    bool ktx2Beside = false; // of glTF
};
baker::ExportOptions exportOptions(const ExportChoices& choices, int threads);

struct ExportArguments {
    std::filesystem::path baked, folder;
    std::string name; // empty: that of the baked file
    ExportChoices choices;
    int threads = 0;
};
void runExport(const ExportArguments& arguments);

struct BakeArguments {
    std::filesystem::path model;        // glTF whose materials are baked, in place of maps
    bool ktx2Textures = false;          // of a model: all levels beside it
    std::filesystem::path exportFolder; // of maps: written for other engines, too
    ExportChoices exported;
    std::filesystem::path height, normal, powerMap, roughness, tangentRotation, output;
    float heightScale = 0.0f;
    bool normalGreenUp = true;                    // green points along the bitangent
    std::string specular = "0.04", diffuse = "0"; // a number, r,g,b or an image
    float power = 200.0f;
    std::vector<float> anisotropicPower; // along T and B; empty = isotropic
    baker::Wrap wrap = baker::Wrap::repeat;
    baker::Options options{.lobes = baker::LobeCount::automatic};
    bool asFloat = false;
    std::vector<std::filesystem::path> reports; // .json, .html
    std::filesystem::path manifest;             // bakes what it lists, in place of all others
    baker::Shard shard;                         // of the manifest
};
// Throws Error naming what failed when a manifest's entries do.
void runBake(const BakeArguments& arguments);
void runBakeModel(const BakeArguments& arguments);

// perScene: automatic for scenes that bring their own lights and would be nearly white or black at
// exposure 1.
enum class ExposureChoice { perScene, automatic, fixed };

// What is rendered, from where and how.
struct SceneArguments {
    std::filesystem::path scene;
    Settings settings;
    ExposureChoice exposure = ExposureChoice::perScene; // else settings.exposure counts
    std::string camera; // name or index; empty = the first, or one that frames the scene
    std::optional<glm::vec3> eye, target;
    float fovDegrees = 40.0f;            // vertical, with eye and target
    int lights = 0;                      // 0 = the scene's
    std::string environment;             // none, sky or a file; empty: sky where the scene has no lights
    std::vector<scene::Light> lightList; // in place of all others
    std::vector<std::pair<std::string, std::filesystem::path>> materialFiles; // name, baked file
    baker::Method filter = baker::Method::fit;
    baker::Model model = baker::Model::ashikhminShirley;
    baker::LobeCount lobes = baker::LobeCount::automatic;
    scene::AskedBake asked; // which of these three were given
    bool useCache = true;
    bool quick = false; // materials that are not in the cache are not baked
    int threads = 0;
    gpu::DeviceOptions device;
};

struct ShotArguments : SceneArguments {
    std::filesystem::path output, stats;
    int frames = 1;
    PathOptions path;
};
void runShot(const ShotArguments& arguments);

// A way of shading by its name in `bench`: tsl, forward, forward-aniso or reference, then optionally a filter
// and a number of samples, each after a hyphen: forward-average, forward-16. With samples it is forward
// shading at the finest level, so many samples per pixel.
struct BenchShading {
    std::string name = "tsl";
    Shading shading = Shading::tsl;
    bool anisotropic = false;              // forward: as --forward-anisotropy says
    std::optional<baker::Method> filter{}; // none: that of --filter
    int samples = 0;                       // 0: that of --samples
};

// From `frame` on, `lights` lights of scene::lightRing().
struct LoadStep {
    int lights = 0, frame = 0;
};

// Each of scenes x sizes x lights x objects x shadings is measured.
struct BenchArguments : SceneArguments {
    BenchArguments() { settings.residency = ResidencyFrom::latest; }
    std::vector<std::filesystem::path> scenes; // none: the stress scene beside the program
    std::vector<BenchShading> shadings{BenchShading()};
    std::vector<glm::uvec2> sizes{{960, 540}};
    std::vector<int> lightCounts{0};  // 0 = the scene's
    std::vector<int> objectCounts{0}; // spread over the scene's; 0 = all
    std::vector<LoadStep> load;       // rising frames from 0 on; in place of lightCounts
    PathOptions path;
    bool defaultPath = true; // none was named: the camera's animation, or an orbit
    int frames = 120, warmup = 10;
    int round = 10; // frames that a run renders before the next run's turn
    int errorEvery = 0;
    bool flicker = false;
    bool floors = false; // the least that each pass could take, too
    std::filesystem::path json, csv, plot;
    std::vector<std::filesystem::path> compare; // two files of `json`: in place of a measurement
    std::optional<double> limit;                // of their ratios
};
// False when a ratio exceeds the limit.
bool runBench(const BenchArguments& arguments);

struct ViewArguments : SceneArguments {
    ViewArguments()
    {
        settings.budgetMs = 33.0;
        settings.residency = ResidencyFrom::latest;
    }
    bool listDevices = false; // and nothing else
    gpu::PresentMode presentMode = gpu::PresentMode::fifo;
    bool split = false; // the right side: shading and filter of its own
    Shading rightShading = Shading::reference;
    baker::Method rightFilter = baker::Method::fit;
    bool panels = true;
    std::optional<double> seconds; // of the animation, which then stands still
};
// Throws Error without a display, or when the first scene cannot be shown.
void runView(const ViewArguments& arguments);

struct CompareArguments {
    std::filesystem::path a, b, output;
    std::optional<double> psnrMin;
};
// False when the PSNR is below psnrMin.
bool runCompare(const CompareArguments& arguments);

struct HelpArguments {
    std::string command; // empty: all
    bool markdown = false;
};

} // namespace lumel
