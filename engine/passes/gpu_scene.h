// A scene on the GPU: meshes, texel maps, material maps, lights, and the object table of each frame.
#pragma once
#include "gpu/pipeline.h"
#include "gpu/resource.h"
#include "scene/materials.h"
#include "scene/scene.h"
#include "tsl/room.h"
#include "tsl/texel_map.h"
#include <map>
#include <memory>

namespace lumel {

// A texel map on the GPU and the tiles to light at each level.
struct GpuTexelMap {
    tsl::TexelMap map; // texels are dropped after upload
    std::vector<std::vector<glm::uvec2>> tiles;
    gpu::Buffer buffer;
};

struct GpuMaterial {
    gpu::Image normal, specular, diffuse, glow, opacity;
    vk::raii::DescriptorSet set = nullptr;
    glm::uvec2 size{1};
};

struct GpuObject {
    shared::Object data; // everything but the frame's lit texture
    const GpuMaterial* material = nullptr;
    const GpuTexelMap* texelMap = nullptr; // null: not to be lit in texture space
    uint32_t indexCount = 0;
    Bounds bounds; // object space
    bool blend = false;
    bool mirrored = false; // the transform flips triangle winding
};

class GpuScene {
public:
    GpuScene(const gpu::Device& device, const scene::Scene& scene,
             const std::vector<scene::BakedMaterial>& materials);

    const std::vector<GpuObject>& objects() const { return objects_; }
    const gpu::SetLayout& materialLayout() const { return materialLayout_; }
    vk::DeviceAddress lights() const { return lights_.address(); }
    uint32_t lightCount() const { return lightCount_; }
    glm::vec3 skyRadiance() const { return sky_; }
    glm::vec3 groundRadiance() const { return ground_; }

    // This frame's objects with the lit textures of `room` (none when empty). Frames are waited for, so one
    // table serves all.
    void writeObjects(const tsl::Room& room);
    vk::DeviceAddress objectTable() const { return objectTable_.address(); }

    // Per object: does its box meet the view volume?
    std::vector<uint8_t> objectsInView(const glm::mat4& clipFromWorld) const;

    // Draws an object's triangles with the bound pipeline, its winding and culling set.
    void drawTriangles(vk::CommandBuffer commands, size_t object) const;

private:
    struct GpuMesh {
        gpu::Buffer vertices, indices;
    };
    void uploadMaterial(const gpu::Device& device, const scene::BakedMaterial& baked,
                        const std::string& name);
    void uploadLights(const gpu::Device& device, const scene::Scene& scene);
    void addObject(const gpu::Device& device, const scene::Scene& scene, const scene::Object& object);
    const GpuTexelMap* texelMapFor(const gpu::Device& device, const scene::Scene& scene, int mesh,
                                   glm::uvec2 grid);

    gpu::SetLayout materialLayout_;
    vk::raii::Sampler sampler_;
    std::vector<GpuMesh> meshes_;
    std::vector<GpuMaterial> materials_;
    std::map<std::tuple<int, uint32_t, uint32_t>, std::unique_ptr<GpuTexelMap>> texelMaps_;
    std::vector<GpuObject> objects_;
    gpu::Buffer lights_, objectTable_;
    uint32_t lightCount_ = 0;
    glm::vec3 sky_{0.0f}, ground_{0.0f};
};

} // namespace lumel
