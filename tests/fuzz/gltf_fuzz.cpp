// libFuzzer target: any bytes as a glTF file, which loads with its material maps or throws Error.
#include "core/decoder_process.h"
#include "core/error.h"
#include "fuzz_file.h"
#include "gltf/gltf.h"
#include "scene/deformation.h"
#include "scene/material_maps.h"
#include <spdlog/spdlog.h>

namespace lumel {
namespace {

void load(const std::filesystem::path& file)
{
    const scene::Scene scene = scene::loadGltf(file);
    const scene::Shapes shapes = scene::shapesAt(scene.skins, scene.deformed, scene.animation, 0.4);
    for (size_t i = 0; i < scene.deformed.size(); ++i) {
        const scene::DeformedMesh& deformed = scene.deformed[i];
        scene::deformedVertices(scene.meshes[size_t(deformed.mesh)],
                                deformed.skin >= 0 ? shapes.joints[size_t(deformed.skin)] : scene::Matrices(),
                                shapes.weights[i]);
    }
    for (const scene::Material& material : scene.materials) {
        scene::reflectanceMaps(scene, material);
        scene::emissiveImage(scene, material);
        scene::opacityImage(scene, material);
    }
}

} // namespace
} // namespace lumel

extern "C" int LLVMFuzzerInitialize(int*, char***)
{
    lumel::decodeInThisProcess();
    return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size)
{
    spdlog::set_level(spdlog::level::off);
    static lumel::FuzzFile file(".gltf");
    try {
        lumel::load(file.write(data, size));
    } catch (const lumel::Error&) { // refused
    }
    return 0;
}
