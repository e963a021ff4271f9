// The scene as one renderer shows it: where its objects are, how they are deformed, what lights them. What is
// large is in SceneResources.
#pragma once
#include "gpu_object.h"
#include "scene_lights.h"
#include <set>

namespace lumel {

class SceneState {
public:
    // The objects, lights and shapes of `scene`, which `resources` are of. It may show a part of the objects
    // that the resources were made for.
    SceneState(const gpu::Device& device, const scene::Scene& scene, const SceneResources& resources);
    SceneState(const SceneState&) = delete;
    SceneState& operator=(const SceneState&) = delete;

    const std::vector<GpuObject>& objects() const { return objects_; }
    // Of the objects, as they are, were or are expected to be.
    const std::set<SurfaceKind>& surfaceKinds() const { return kinds_; }
    const gpu::SetLayout& materialLayout() const { return resources_.materials->layout(); }
    const gpu::SetLayout& vertexTexelLayout() const { return resources_.geometry->vertexTexelLayout(); }
    FrameSet& frameSet() { return frameSet_; }
    const FrameSet& frameSet() const { return frameSet_; }
    SceneLights& lights() { return lights_; }
    const SceneLights& lights() const { return lights_; }
    DeformedMeshes& deformedMeshes() { return deformed_; }
    const DeformedMeshes& deformedMeshes() const { return deformed_; }

    // As of `frame`. What has changed is lit again.
    void moveObject(size_t object, const glm::mat4& worldFromObject, uint32_t frame);
    void deform(const scene::Shapes& shapes, uint32_t frame); // all that has joints or morph targets
    void changeMaterial(size_t material, uint32_t frame);
    // Materials that may gain second lobes.
    void expectSecondLobes(const std::set<size_t>& materials);
    uint32_t moved() const { return changed_; } // frame of the last change to objects
    // Frame of the last change to lights or objects.
    uint32_t changed() const { return std::max(changed_, lights_.changed()); }
    // Has the object moved in this frame or later, or a light that may reach it?
    bool changedSince(size_t object, uint32_t frame) const;

    // The place of the next frame in the rings.
    void begin(uint32_t place);
    // Writes that frame's objects, without lit textures: these may be added.
    void writeObjects();
    const gpu::Buffer& objectTable() const { return frameSet_.objectTable(); }

private:
    // Declared in creation order, since they die in reverse.
    SceneResources resources_;
    FrameSet frameSet_;
    SceneLights lights_;
    DeformedMeshes deformed_;
    std::vector<GpuObject> objects_;
    std::set<SurfaceKind> kinds_;
    uint32_t changed_ = 0; // frame in which an object last did
};

} // namespace lumel
