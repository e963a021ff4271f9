#include "scene_resources.h"
#include <future>

namespace lumel {

SceneResources uploadScene(const gpu::Device& device, const scene::Scene& scene,
                           const std::vector<scene::BakedMaterial>& materials)
{
    // Geometry keeps the processor busy, materials memory and the device.
    auto uploaded = std::async(std::launch::async,
                               [&] { return std::make_shared<MaterialResources>(device, scene, materials); });
    SceneResources resources;
    resources.geometry = std::make_shared<const GeometryResources>(device, scene, materials);
    resources.environment = std::make_shared<const EnvironmentMap>(device, scene.environment.get());
    resources.materials = uploaded.get();
    return resources;
}

} // namespace lumel
