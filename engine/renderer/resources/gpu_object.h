// An object of the scene as shaders read it, and what draws it.
#pragma once
#include "deformed_meshes.h"
#include "scene_resources.h"

namespace lumel {

struct GpuObject {
    shared::Object data; // everything but the frame's lit texture
    const GpuMaterial* material = nullptr;
    const GpuTexelMap* texelMap = nullptr; // null: not to be lit in texture space
    vk::Buffer vertices, indices;
    uint32_t indexCount = 0;
    Bounds bounds;     // object space
    int deformed = -1; // in SceneState::deformedMeshes()
    bool blend = false;
    bool coloured = false; // its vertices have colours
    bool casts = true;     // a shadow
    bool mirrored = false; // the transform flips triangle winding
};

// As the scene has it. The resources outlive it.
GpuObject makeObject(const scene::Scene& scene, const scene::Object& object, const SceneResources& resources,
                     const DeformedMeshes& deformed);

// Moves it. True when it was elsewhere.
bool place(GpuObject& object, const glm::mat4& worldFromObject, const DeformedMeshes& deformed);
// Follows its deformed mesh, where it has one: its box and its winding.
void takeShape(GpuObject& object, const DeformedMeshes& deformed);

} // namespace lumel
