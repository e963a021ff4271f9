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
    vk::DescriptorSet vertexTexels; // of all vertices in their buffer
    uint32_t firstVertex = 0, firstIndex = 0, indexCount = 0;
    Bounds bounds;      // object space
    uint32_t moved = 0; // frame in which it last did, or its shape
    int deformed = -1;  // in SceneState::deformedMeshes()
    bool blend = false;
    bool coloured = false; // its vertices have colours
    bool casts = true;     // a shadow
    bool mirrored = false; // the transform flips triangle winding
};

// kFeature... of an object's own, which shaders that look up its material are made for.
uint32_t surfaceFeatures(const GpuObject& object);

// What of an object decides about the pipelines that draw and light it.
struct SurfaceKind {
    uint32_t features = 0; // surfaceFeatures()
    bool blend = false, mask = false, lightable = false, deformed = false;
    auto operator<=>(const SurfaceKind&) const = default;
};
SurfaceKind kindOf(const GpuObject& object);

// As the scene has it. The resources outlive it.
GpuObject makeObject(const scene::Scene& scene, const scene::Object& object, const SceneResources& resources,
                     const DeformedMeshes& deformed);

// Moves it. True when it was elsewhere.
bool place(GpuObject& object, const glm::mat4& worldFromObject, const DeformedMeshes& deformed);
// Follows its deformed mesh, where it has one: its box and its winding.
void takeShape(GpuObject& object, const DeformedMeshes& deformed);
// Follows its material, which may gain or lose second lobes.
void takeLobes(GpuObject& object);

} // namespace lumel
