// What the renderers of a scene share: everything of it that is large.
#pragma once
#include "environment_map.h"
#include "geometry_resources.h"
#include "material_resources.h"
#include <memory>

namespace lumel {

struct SceneResources {
    std::shared_ptr<const GeometryResources> geometry;
    std::shared_ptr<MaterialResources> materials;
    std::shared_ptr<const EnvironmentMap> environment; // may be of no environment, is never null
};

// Of the scene and one bake of its materials.
SceneResources uploadScene(const gpu::Device& device, const scene::Scene& scene,
                           const std::vector<scene::BakedMaterial>& materials);

} // namespace lumel
