#include "geometry_resources.h"
#include "tsl/chart_levels.h"
#include "tsl/packed_texels.h"
#include "upload.h"
#include <algorithm>

namespace lumel {
namespace {

void upload(gpu::UploadBatch& batch, const scene::Mesh& mesh, GpuMesh& result)
{
    const auto buffer = [&](const auto& data, const char* what) {
        return batch.buffer(data, mesh.name + what, gpu::MemoryKind::geometry);
    };
    result.colours = uploadColours(batch, mesh);
    result.indexCount = uint32_t(mesh.indices.size());
    const scene::Deformation& d = mesh.deformation;
    if (!d.influences.empty())
        result.influences = buffer(d.influences, " influences");
    if (!d.deltas.empty()) {
        result.firstDeltas = buffer(d.firstDeltas, " first deltas");
        result.deltas = buffer(d.deltas, " deltas");
    }
}

bool readsMaterialAtLitUvs(const scene::Mesh& mesh)
{
    return std::all_of(mesh.vertices.begin(), mesh.vertices.end(),
                       [](const shared::Vertex& v) { return v.materialUv == v.uv && v.emissionUv == v.uv; });
}

// Level of a map of this size that matches the lit texture's level 0; below 0 where lumels are finer. By the
// axis in which a lumel covers more texels, but at most one level coarser than by the other: as light.comp's
// levelOf() does.
float levelOfLumels(glm::ivec2 mapSize, glm::uvec2 litSize)
{
    const glm::vec2 texels = glm::vec2(mapSize) / glm::vec2(litSize);
    const float major = std::max(texels.x, texels.y), minor = std::min(texels.x, texels.y);
    return std::log2(std::max(minor, 0.5f * major));
}

} // namespace

GeometryResources::GeometryResources(const gpu::Device& device, const scene::Scene& scene,
                                     const std::vector<scene::BakedMaterial>& materials)
    : buffers_(device)
{
    meshes_.resize(scene.meshes.size()); // before the batch: it must not outlive what it fills
    gpu::UploadBatch batch(device);
    buffers_.upload(batch, scene.meshes);
    for (size_t i = 0; i < meshes_.size(); ++i) {
        meshes_[i].vertices = buffers_.parts()[i].vertices;
        meshes_[i].indices = buffers_.parts()[i].indices;
        meshes_[i].texels = buffers_.parts()[i].texels;
        upload(batch, scene.meshes[i], meshes_[i]);
    }
    for (const scene::Object& object : scene.objects)
        if (const std::pair key(object.mesh, object.material); !surfaces_.contains(key))
            surfaces_[key] = makeSurface(batch, scene, object, materials[size_t(object.material)]);
    batch.finish();
}

GpuSurface GeometryResources::makeSurface(gpu::UploadBatch& batch, const scene::Scene& scene,
                                          const scene::Object& object, const scene::BakedMaterial& baked)
{
    const scene::Mesh& mesh = scene.meshes[size_t(object.mesh)];
    const glm::ivec2 size = baked.reflectance.size(), emissiveSize = baked.emissive.size();
    GpuSurface surface;
    surface.ownMaterialUv = !readsMaterialAtLitUvs(mesh);
    surface.litSize =
        surface.ownMaterialUv ? tsl::lumelGrid(mesh, size, emissiveSize) : tsl::lumelGrid(size, emissiveSize);
    surface.materialLevelOffset = levelOfLumels(size, surface.litSize);
    surface.emissiveLevelOffset = levelOfLumels(emissiveSize, surface.litSize);
    const bool opaque = scene.materials[size_t(object.material)].alphaMode == scene::AlphaMode::opaque;
    if (opaque && mesh.uvProblem.empty())
        surface.texelMap = texelMapFor(batch, mesh, object.mesh, surface.litSize);
    return surface;
}

const GpuTexelMap* GeometryResources::texelMapFor(gpu::UploadBatch& batch, const scene::Mesh& mesh, int index,
                                                  glm::uvec2 grid)
{
    const auto [entry, isNew] = texelMaps_.try_emplace({index, grid.x, grid.y});
    GpuTexelMap& result = entry->second;
    if (isNew) {
        result.map = tsl::makeTexelMap(mesh, grid);
        const tsl::PackedTexels packed = tsl::pack(result.map);
        result.offsets = packed.offsets;
        result.buffer =
            batch.buffer(std::as_bytes(std::span(packed.words)), "texel map", gpu::MemoryKind::texelMaps);
        result.coarsest = tsl::coarsestWithoutSeams(tsl::seamShares(mesh, result.map));
        result.map.texels = {};
    }
    return &result;
}

} // namespace lumel
