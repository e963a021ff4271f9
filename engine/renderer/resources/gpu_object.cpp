#include "gpu_object.h"
#include <algorithm>

namespace lumel {
namespace {

// What is not metal reflects this much whatever its base colour is. In a specular-glossiness material the
// base colour does not affect reflectance: -1.
float dielectricReflectance(const scene::Material& material)
{
    if (material.specularGlossiness)
        return -1.0f;
    const float ratio = (material.ior - 1.0f) / (material.ior + 1.0f); // KHR_materials_ior; 0 gives 1
    return ratio * ratio * material.specular;
}

uint32_t flagsOf(const scene::Material& material, const GpuSurface& surface)
{
    return (material.doubleSided ? shared::kObjectDoubleSided : 0u) |
           (material.unlit ? shared::kObjectUnlit : 0u) |
           (surface.ownMaterialUv ? shared::kObjectOwnMaterialUv : 0u) |
           (material.alphaMode == scene::AlphaMode::mask ? shared::kObjectMask : 0u) |
           (surface.texelMap ? shared::kObjectLightable : 0u);
}

shared::Object dataOf(const scene::Material& material, const GpuMesh& mesh, const BufferPart& vertices,
                      const GpuSurface& surface)
{
    shared::Object data{};
    data.vertices = vertices.address;
    data.firstVertex = vertices.first;
    data.indices = mesh.indices.address;
    data.colours = mesh.colours.address();
    data.dielectric = dielectricReflectance(material);
    data.litSize = surface.litSize;
    data.materialLevelOffset = surface.materialLevelOffset;
    data.emissiveLevelOffset = surface.emissiveLevelOffset;
    data.flags = flagsOf(material, surface);
    data.alphaCutoff = material.alphaCutoff;
    if (surface.texelMap) {
        data.texels = surface.texelMap->buffer.address();
        std::ranges::copy(surface.texelMap->offsets, data.texelOffsets);
    }
    return data;
}

BufferPart verticesOf(const scene::Object& object, const GpuMesh& mesh, const DeformedMeshes& deformed)
{
    if (object.deformed < 0)
        return mesh.vertices;
    const gpu::Buffer& own = deformed.items()[size_t(object.deformed)].vertices;
    return {.buffer = own.handle(), .address = own.address()};
}

} // namespace

uint32_t surfaceFeatures(const GpuObject& object)
{
    return materialFeatures(*object.material) | (object.coloured ? shared::kFeatureColoured : 0u);
}

SurfaceKind kindOf(const GpuObject& object)
{
    return {.features = surfaceFeatures(object),
            .blend = object.blend,
            .mask = (object.data.flags & shared::kObjectMask) != 0,
            .lightable = object.texelMap != nullptr,
            .deformed = object.deformed >= 0};
}

GpuObject makeObject(const scene::Scene& scene, const scene::Object& object, const SceneResources& resources,
                     const DeformedMeshes& deformed)
{
    const scene::Material& material = scene.materials[size_t(object.material)];
    const GpuMesh& mesh = resources.geometry->meshes()[size_t(object.mesh)];
    const GpuSurface& surface = resources.geometry->surface(object.mesh, object.material);
    const BufferPart vertices = verticesOf(object, mesh, deformed);
    // An object that emits everywhere stands for a light, and would shadow it.
    const bool emits = material.unlit || (material.emissive != glm::vec3(0.0f) && material.emissiveImage < 0);
    const bool blend = material.alphaMode == scene::AlphaMode::blend;
    GpuObject result{.data = dataOf(material, mesh, vertices, surface),
                     .material = &resources.materials->all()[size_t(object.material)],
                     .texelMap = surface.texelMap,
                     .vertices = vertices.buffer,
                     .indices = mesh.indices.buffer,
                     .vertexTexels = object.deformed < 0
                                         ? mesh.texels
                                         : deformed.items()[size_t(object.deformed)].texels->set(),
                     .firstVertex = vertices.first,
                     .firstIndex = mesh.indices.first,
                     .indexCount = mesh.indexCount,
                     .bounds = scene.meshes[size_t(object.mesh)].bounds,
                     .deformed = object.deformed,
                     .blend = blend,
                     .coloured = bool(mesh.colours),
                     .casts = !blend && !emits};
    if (object.deformed >= 0)
        result.data.flags |= shared::kObjectDeformed;
    takeLobes(result);
    place(result, object.worldFromObject, deformed);
    return result;
}

void takeLobes(GpuObject& object)
{
    object.data.flags &= ~shared::kObjectSecondLobe;
    object.data.flags |= object.material->second ? shared::kObjectSecondLobe : 0u;
}

bool place(GpuObject& object, const glm::mat4& worldFromObject, const DeformedMeshes& deformed)
{
    if (object.data.worldFromObject == worldFromObject)
        return false; // animations pause
    object.data.worldFromObject = worldFromObject;
    object.data.worldFromObjectNormal = glm::transpose(glm::inverse(glm::mat3(worldFromObject)));
    takeShape(object, deformed);
    return true;
}

void takeShape(GpuObject& object, const DeformedMeshes& deformed)
{
    object.mirrored = glm::determinant(glm::mat3(object.data.worldFromObject)) < 0.0f;
    object.data.flags &= ~shared::kObjectMirrored;
    object.data.flags |= object.mirrored ? shared::kObjectMirrored : 0u;
    if (object.deformed < 0)
        return;
    const DeformedMeshes::Item& item = deformed.items()[size_t(object.deformed)];
    object.bounds = item.bounds;
    object.mirrored = object.mirrored != item.mirrored;
}

} // namespace lumel
