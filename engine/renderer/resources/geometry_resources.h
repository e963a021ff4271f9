// A scene's meshes on the GPU with their texel maps. They never change, so all renderers of a scene share
// them, whatever its materials are baked by.
#pragma once
#include "mesh_buffers.h"
#include "scene/materials.h"
#include "tsl/texel_map.h"
#include <map>

namespace lumel {

struct GpuMesh {
    BufferPart vertices, indices; // at rest
    vk::DescriptorSet texels;     // of the vertices' buffer
    gpu::Buffer colours;          // none: all white
    uint32_t indexCount = 0;
    // Of what moves its vertices; none where nothing does.
    gpu::Buffer influences, firstDeltas, deltas;
};

// A texel map on the GPU.
struct GpuTexelMap {
    tsl::TexelMap map;                                  // texels are dropped after upload
    gpu::Buffer buffer;                                 // tsl::PackedTexels
    std::array<uint32_t, shared::kMaxLevels> offsets{}; // of its levels
    uint32_t coarsest = 0;                              // level at which charts keep clear of each other
};

// A mesh with a material, as lit texture.
struct GpuSurface {
    glm::uvec2 litSize{1};      // lumels of level 0
    bool ownMaterialUv = false; // materials are read elsewhere than light is
    float materialLevelOffset = 0.0f, emissiveLevelOffset = 0.0f; // map level = lit level + this
    const GpuTexelMap* texelMap = nullptr;                        // null: not to be lit in texture space
};

class GeometryResources {
public:
    // materials: the sizes of their maps decide how many lumels a surface has. Other bakes of the same
    // materials have the same.
    GeometryResources(const gpu::Device& device, const scene::Scene& scene,
                      const std::vector<scene::BakedMaterial>& materials);

    const std::vector<GpuMesh>& meshes() const { return meshes_; }
    const gpu::SetLayout& vertexTexelLayout() const { return buffers_.texelLayout(); }
    // Of an object of the scene.
    const GpuSurface& surface(int mesh, int material) const { return surfaces_.at({mesh, material}); }

private:
    GpuSurface makeSurface(gpu::UploadBatch& batch, const scene::Scene& scene, const scene::Object& object,
                           const scene::BakedMaterial& baked);
    const GpuTexelMap* texelMapFor(gpu::UploadBatch& batch, const scene::Mesh& mesh, int index,
                                   glm::uvec2 grid);

    MeshBuffers buffers_;
    std::vector<GpuMesh> meshes_;
    std::map<std::tuple<int, uint32_t, uint32_t>, GpuTexelMap> texelMaps_; // by mesh and grid
    std::map<std::pair<int, int>, GpuSurface> surfaces_;                   // by mesh and material
};

} // namespace lumel
