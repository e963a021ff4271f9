// The commands behind main(): options as plain data in, exit through Error or return.
#pragma once
#include "baker/bake.h"
#include "gpu/device.h"
#include "gpu/present_mode.h"
#include "passes/settings.h"
#include "scene/camera_path.h"
#include <filesystem>
#include <optional>
#include <string>

namespace lumel {

struct BakeArguments {
    std::filesystem::path height, normal, powerMap, roughness, tangentRotation, output;
    float heightScale = 0.0f;
    std::string normalGreen = "up";
    std::string specular = "0.04", diffuse = "0"; // a number, r,g,b or an image
    float power = 200.0f;
    std::vector<float> anisotropicPower; // along T and B; empty = isotropic
    baker::Wrap wrap = baker::Wrap::repeat;
    baker::Options options;
    bool asFloat = false;
    std::vector<std::filesystem::path> reports; // .json, .html
    std::filesystem::path manifest;             // bakes what it lists, in place of all others
};
// Throws Error naming what failed when a manifest's entries do.
void runBake(const BakeArguments& arguments);

// What is rendered, from where and how.
struct SceneArguments {
    std::filesystem::path scene;
    Settings settings;
    std::string camera; // name or index; empty = the first, or one that frames the scene
    std::optional<glm::vec3> eye, target;
    float fovDegrees = 40.0f;                                                 // vertical, with eye and target
    int lights = 0;                                                           // 0 = the scene's
    std::vector<scene::Light> lightList;                                      // in place of all others
    std::vector<std::pair<std::string, std::filesystem::path>> materialFiles; // name, baked file
    baker::Method filter = baker::Method::fit;
    baker::Model model = baker::Model::ashikhminShirley;
    bool useCache = true;
    int threads = 0;
    gpu::DeviceOptions device;
};

struct ShotArguments : SceneArguments {
    std::filesystem::path output, stats;
    int frames = 1;
    scene::Path path = scene::Path::still;
    std::optional<double> step; // degrees or percent a frame; none = the path's usual one
};
void runShot(const ShotArguments& arguments);

struct ViewArguments : SceneArguments {
    bool listDevices = false; // and nothing else
    gpu::PresentMode presentMode = gpu::PresentMode::fifo;
    bool split = false; // the right side: shading and filter of its own
    Shading rightShading = Shading::reference;
    baker::Method rightFilter = baker::Method::fit;
    bool panels = true;
};
// Throws Error without a display, or when the first scene cannot be shown.
void runView(const ViewArguments& arguments);

struct CompareArguments {
    std::filesystem::path a, b, output;
    std::optional<double> psnrMin;
};
// False when the PSNR is below psnrMin.
bool runCompare(const CompareArguments& arguments);

} // namespace lumel
