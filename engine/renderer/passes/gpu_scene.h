// A scene on the GPU: meshes, texel maps, material maps, lights, and the object table of each frame.
#pragma once
#include "deformed_meshes.h"
#include "gpu/pipeline.h"
#include "gpu/resource.h"
#include "scene/materials.h"
#include "scene/scene.h"
#include "tsl/chart_levels.h"
#include "tsl/residency.h"
#include <array>
#include <map>
#include <memory>

namespace lumel {

class LitPool;

// A texel map on the GPU.
struct GpuTexelMap {
    tsl::TexelMap map; // texels are dropped after upload
    gpu::Buffer buffer;
    uint32_t coarsest = 0; // level at which charts keep clear of each other
};

struct GpuMaterial {
    gpu::Image normal, specular, diffuse, emissive, opacity;
    gpu::Image base; // mean F0 and roughness of level 0
    vk::raii::DescriptorSet set = nullptr;
    glm::uvec2 size{1}, emissiveSize{1}; // of the reflectance and of emissive, texels
};

struct GpuObject {
    shared::Object data; // everything but the frame's lit texture
    const GpuMaterial* material = nullptr;
    const GpuTexelMap* texelMap = nullptr; // null: not to be lit in texture space
    vk::Buffer vertices, indices;
    uint32_t indexCount = 0;
    Bounds bounds;     // object space
    int deformed = -1; // in GpuScene::deformedMeshes()
    bool blend = false;
    bool coloured = false; // its vertices have colours
    bool casts = true;     // a shadow
    bool mirrored = false; // the transform flips triangle winding
};

// The jobs that an object's tiles belong to.
struct ObjectJobs {
    uint32_t light = 0, lower = 0;
};

class GpuScene {
public:
    GpuScene(const gpu::Device& device, const scene::Scene& scene,
             const std::vector<scene::BakedMaterial>& materials);

    const std::vector<GpuObject>& objects() const { return objects_; }
    const gpu::SetLayout& materialLayout() const { return materialLayout_; }
    // The view and the lights: set 0 of every pipeline. Frames are waited for, so one set serves all.
    const gpu::SetLayout& frameLayout() const { return frameLayout_; }
    vk::DescriptorSet frameSet() const { return *frameSet_; }
    vk::Buffer viewBuffer() const { return view_.handle(); }
    void writeView(const shared::View& view) { *view_.mapped<shared::View>() = view; }
    // Lights as of `frame`: what a light that changed reaches is lit again. Throws Error beyond kMaxLights.
    void setLights(const std::vector<scene::Light>& lights, uint32_t frame);
    void moveObject(size_t object, const glm::mat4& worldFromObject, uint32_t frame);
    // The shapes of all that bends. What has changed is lit again.
    void deform(const scene::Shapes& shapes, uint32_t frame);
    DeformedMeshes& deformedMeshes() { return deformed_; }
    const DeformedMeshes& deformedMeshes() const { return deformed_; }
    // Null: none. Call when no frame is in flight; all objects are lit again.
    void setEnvironment(const gpu::Device& device, std::shared_ptr<const scene::Environment> environment,
                        uint32_t frame);
    // What the environment's picture is multiplied by, and turned by about +Y, in degrees.
    void adjustEnvironment(float intensity, float degrees, uint32_t frame);
    // See Settings::ambient.
    void adjustAmbient(std::optional<float> ambient, uint32_t frame);
    const shared::EnvironmentView& environment() const { return environmentView_; }
    // kFeature... of shaders that light its objects, or those of them that have vertex colours.
    uint32_t features(bool coloured = false) const
    {
        return (environment_ ? shared::kFeatureEnvironment : 0u) |
               (shadows_.empty() ? 0u : shared::kFeatureShadows) | (coloured ? shared::kFeatureColoured : 0u);
    }
    // Of ShadowPass.
    void bindShadows(const gpu::Device& device, vk::Sampler sampler, vk::ImageView maps);
    void setShadows(const std::vector<shared::Shadow>& shadows, uint32_t frame);
    const std::vector<shared::Shadow>& shadows() const { return shadows_; }
    std::span<const shared::Light> lights() const { return {lights_.mapped<shared::Light>(), lightCount_}; }
    void touchLight(uint32_t light, uint32_t frame)
    {
        lights_.mapped<shared::Light>()[light].changed = changed_ = frame;
    }
    uint32_t changed() const { return changed_; } // frame of the last change to lights or objects
    uint32_t lightCount() const { return lightCount_; }
    glm::vec3 skyRadiance() const { return sky_; }
    glm::vec3 groundRadiance() const { return ground_; }

    // This frame's objects without lit textures, or with those of `residency`. Frames are waited for, so one
    // table serves all.
    void writeObjects();
    void writeObjects(const tsl::Residency& residency, const LitPool& pool,
                      const std::vector<ObjectJobs>& jobs);
    vk::DeviceAddress objectTable() const { return objectTable_.address(); }

    // Per object: does its box meet the view volume?
    std::vector<uint8_t> objectsInView(const glm::mat4& clipFromWorld) const;

    // The lights that may reach the object, by its bounding ball: bit i of word i / 32 is light i.
    std::array<uint32_t, shared::kListedLights / 32> lightsReaching(size_t object) const;

    // Has the object moved in this frame, or a light that may reach it?
    bool changedIn(size_t object, uint32_t frame) const;

    // Draws an object's triangles with the bound pipeline, its winding and culling set.
    void drawTriangles(vk::CommandBuffer commands, size_t object) const;

private:
    struct GpuMesh {
        gpu::Buffer vertices, indices, colours;
    };
    void uploadMaterial(const gpu::Device& device, const scene::BakedMaterial& baked,
                        const scene::Material& material);
    vk::Sampler samplerOf(const scene::UvMapping& uv) const
    {
        return *samplers_[size_t(uv.wrapU) + 3 * size_t(uv.wrapV)];
    }
    void makeFrameSet(const gpu::Device& device);
    void updateAmbient(uint32_t frame);
    void touchAll(uint32_t frame);
    void addObject(const gpu::Device& device, const scene::Scene& scene, const scene::Object& object);
    const GpuTexelMap* texelMapFor(const gpu::Device& device, const scene::Scene& scene, int mesh,
                                   glm::uvec2 grid);
    void takeShape(GpuObject& object) const;

    gpu::SetLayout frameLayout_, materialLayout_;
    vk::raii::DescriptorSet frameSet_ = nullptr;
    std::vector<vk::raii::Sampler> samplers_; // by wrapU + 3 wrapV
    std::vector<GpuMesh> meshes_;
    DeformedMeshes deformed_;
    std::vector<GpuMaterial> materials_;
    std::map<std::tuple<int, uint32_t, uint32_t>, std::unique_ptr<GpuTexelMap>> texelMaps_;
    std::vector<GpuObject> objects_;
    gpu::Buffer view_, lights_, objectTable_;
    std::shared_ptr<const scene::Environment> environment_;
    gpu::Image environmentMap_;
    shared::EnvironmentView environmentView_{};
    float environmentDegrees_ = 0.0f;
    std::vector<shared::Shadow> shadows_;
    uint32_t changed_ = 0;
    uint32_t lightCount_ = 0;
    std::optional<float> ambient_;
    float brightestSun_ = 0.0f; // lux
    glm::vec3 sky_{0.0f}, ground_{0.0f};
};

} // namespace lumel
