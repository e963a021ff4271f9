#include "scene_resources.h"

namespace lumel {

SceneResources uploadScene(const gpu::Device& device, const scene::Scene& scene,
                           const std::vector<scene::BakedMaterial>& materials)
{
    return {.geometry = std::make_shared<const GeometryResources>(device, scene, materials),
            .materials = std::make_shared<const MaterialResources>(device, scene, materials),
            .environment = std::make_shared<const EnvironmentMap>(device, scene.environment.get())};
}

} // namespace lumel
