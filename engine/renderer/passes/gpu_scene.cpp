#include "gpu_scene.h"
#include "lit_pool.h"
#include "scene/environment.h"
#include "scene/material_maps.h"
#include "upload.h"

namespace lumel {
namespace {

// By scene::Wrap.
constexpr std::array kAddressModes = {vk::SamplerAddressMode::eRepeat,
                                      vk::SamplerAddressMode::eMirroredRepeat,
                                      vk::SamplerAddressMode::eClampToEdge};

bool readsMaterialAtLitUvs(const scene::Mesh& mesh)
{
    return std::all_of(mesh.vertices.begin(), mesh.vertices.end(),
                       [](const shared::Vertex& v) { return v.materialUv == v.uv && v.emissionUv == v.uv; });
}

// Level of a map of this size that matches the lit texture's level 0; below 0 where lumels are finer. By the
// axis in which a lumel covers more texels, but at most one level coarser than by the other: as light.comp's
// levelOf() does.
float levelOfLumels(glm::uvec2 mapSize, glm::uvec2 litSize)
{
    const glm::vec2 texels = glm::vec2(mapSize) / glm::vec2(litSize);
    const float major = std::max(texels.x, texels.y), minor = std::min(texels.x, texels.y);
    return std::log2(std::max(minor, 0.5f * major));
}

// What is not metal reflects this much whatever its base colour is; that of a specular-glossiness material
// has no say in reflectance at all: -1.
float dielectricReflectance(const scene::Material& material)
{
    if (material.specularGlossiness)
        return -1.0f;
    const float ratio = (material.ior - 1.0f) / (material.ior + 1.0f); // KHR_materials_ior; 0 gives 1
    return ratio * ratio * material.specular;
}

} // namespace

GpuScene::GpuScene(const gpu::Device& device, const scene::Scene& scene,
                   const std::vector<scene::BakedMaterial>& materials)
    : frameLayout_(gpu::makeSetLayout(
          device, {vk::DescriptorType::eUniformBuffer, vk::DescriptorType::eUniformBuffer,
                   vk::DescriptorType::eCombinedImageSampler, vk::DescriptorType::eCombinedImageSampler})),
      materialLayout_(gpu::makeSetLayout(
          device, std::vector<vk::DescriptorType>(6, vk::DescriptorType::eCombinedImageSampler)))
{
    for (const auto v : kAddressModes)
        for (const auto u : kAddressModes)
            samplers_.emplace_back(device.handle(),
                                   vk::SamplerCreateInfo{.magFilter = vk::Filter::eLinear,
                                                         .minFilter = vk::Filter::eLinear,
                                                         .mipmapMode = vk::SamplerMipmapMode::eLinear,
                                                         .addressModeU = u,
                                                         .addressModeV = v,
                                                         .maxLod = VK_LOD_CLAMP_NONE});
    for (const scene::Mesh& mesh : scene.meshes)
        meshes_.push_back({gpu::uploadBuffer(device, mesh.vertices, mesh.name + " vertices"),
                           gpu::uploadBuffer(device, mesh.indices, mesh.name + " indices"),
                           uploadColours(device, mesh)});
    std::vector<vk::DeviceAddress> restVertices;
    for (const GpuMesh& mesh : meshes_)
        restVertices.push_back(mesh.vertices.address());
    deformed_ = DeformedMeshes(device, scene, restVertices);
    materials_.reserve(materials.size()); // sets point into it
    for (size_t i = 0; i < materials.size(); ++i)
        uploadMaterial(device, materials[i], scene.materials[i]);
    makeFrameSet(device);
    setEnvironment(device, scene.environment, 0);
    setLights(scene::lightsOf(scene), 0);
    for (const scene::Object& object : scene.objects)
        addObject(device, scene, object);
    objectTable_ = gpu::Buffer(device, objects_.size() * sizeof(shared::Object),
                               gpu::Buffer::MemoryUsage::host, "objects");
}

void GpuScene::uploadMaterial(const gpu::Device& device, const scene::BakedMaterial& baked,
                              const scene::Material& source)
{
    using enum baker::Channel;
    const std::string& name = source.name;
    const auto& mips = baked.reflectance;
    const auto width = uint32_t(mips.levels.front().width), height = uint32_t(mips.levels.front().height);
    const auto upload = [&](std::array<baker::Channel, 4> channels, const char* what) {
        return uploadChannels(device, mips, channels, name + what);
    };
    GpuMaterial material;
    material.size = {width, height};
    material.emissiveSize = {uint32_t(baked.emissive.front().width), uint32_t(baked.emissive.front().height)};
    material.normal = upload({kNx, kNy, kSxx, kSyy}, " normal");
    material.specular = upload({kKsR, kKsG, kKsB, kSxy}, " specular");
    material.diffuse = upload({kKdR, kKdG, kKdB, kError}, " diffuse");
    material.emissive = uploadChain(device, baked.emissive, name + " emissive");
    material.opacity = uploadChain(device, baked.opacity, name + " opacity");
    material.base = uploadChain(device, scene::baseReflectance(mips), name + " base");
    material.set = gpu::makeSet(device, materialLayout_);
    uint32_t binding = 0;
    for (const gpu::Image* image : {&material.normal, &material.specular, &material.diffuse,
                                    &material.emissive, &material.opacity, &material.base})
        gpu::writeSampled(device, *material.set, binding++,
                          samplerOf(image == &material.emissive ? source.emissionUv : source.uv),
                          image->view());
    materials_.push_back(std::move(material));
}

void GpuScene::makeFrameSet(const gpu::Device& device)
{
    using MemoryUsage = gpu::Buffer::MemoryUsage;
    view_ = gpu::Buffer(device, sizeof(shared::View), MemoryUsage::host, "view");
    lights_ = gpu::Buffer(device, shared::kMaxLights * sizeof(shared::Light), MemoryUsage::host, "lights");
    frameSet_ = gpu::makeSet(device, frameLayout_);
    gpu::writeUniform(device, *frameSet_, 0, view_.handle());
    gpu::writeUniform(device, *frameSet_, 1, lights_.handle());
}

void GpuScene::moveObject(size_t object, const glm::mat4& worldFromObject, uint32_t frame)
{
    shared::Object& data = objects_[object].data;
    if (data.worldFromObject == worldFromObject)
        return; // animations pause
    data.worldFromObject = worldFromObject;
    data.worldFromObjectNormal = glm::transpose(glm::inverse(glm::mat3(worldFromObject)));
    data.changed = changed_ = frame;
    takeShape(objects_[object]);
}

void GpuScene::deform(const scene::Shapes& shapes, uint32_t frame)
{
    const std::vector<uint8_t> moved = deformed_.set(shapes);
    for (GpuObject& object : objects_)
        if (object.deformed >= 0 && moved[size_t(object.deformed)]) {
            takeShape(object);
            object.data.changed = changed_ = frame;
        }
}

void GpuScene::takeShape(GpuObject& object) const
{
    object.mirrored = glm::determinant(glm::mat3(object.data.worldFromObject)) < 0.0f;
    object.data.flags &= ~shared::kObjectMirrored;
    object.data.flags |= object.mirrored ? shared::kObjectMirrored : 0u;
    if (object.deformed < 0)
        return;
    const DeformedMeshes::Item& item = deformed_.items()[size_t(object.deformed)];
    object.bounds = item.bounds;
    object.mirrored = object.mirrored != item.mirrored;
}

const GpuTexelMap* GpuScene::texelMapFor(const gpu::Device& device, const scene::Scene& scene, int mesh,
                                         glm::uvec2 grid)
{
    auto& slot = texelMaps_[{mesh, grid.x, grid.y}];
    if (!slot) {
        slot = std::make_unique<GpuTexelMap>();
        slot->map = tsl::makeTexelMap(scene.meshes[size_t(mesh)], grid);
        slot->buffer = gpu::uploadBuffer(device, slot->map.texels, "texel map");
        slot->coarsest = tsl::coarsestWithoutSeams(tsl::seamShares(scene.meshes[size_t(mesh)], slot->map));
        slot->map.texels = {};
    }
    return slot.get();
}

void GpuScene::addObject(const gpu::Device& device, const scene::Scene& scene, const scene::Object& object)
{
    const scene::Mesh& mesh = scene.meshes[size_t(object.mesh)];
    const scene::Material& material = scene.materials[size_t(object.material)];
    const GpuMaterial& gpuMaterial = materials_[size_t(object.material)];
    GpuObject result;
    result.material = &gpuMaterial;
    result.vertices = object.deformed >= 0 ? deformed_.items()[size_t(object.deformed)].vertices.handle()
                                           : meshes_[size_t(object.mesh)].vertices.handle();
    result.indices = meshes_[size_t(object.mesh)].indices.handle();
    result.indexCount = uint32_t(mesh.indices.size());
    result.bounds = mesh.bounds;
    result.deformed = object.deformed;
    result.coloured = !mesh.colours.empty();
    result.blend = material.alphaMode == scene::AlphaMode::blend;
    // What emits all over stands for a light, and would shade it.
    const bool emits = material.unlit || (material.emissive != glm::vec3(0.0f) && material.emissiveImage < 0);
    result.casts = !result.blend && !emits;

    shared::Object& data = result.data;
    data = {};
    data.vertices = object.deformed >= 0 ? deformed_.items()[size_t(object.deformed)].vertices.address()
                                         : meshes_[size_t(object.mesh)].vertices.address();
    data.indices = meshes_[size_t(object.mesh)].indices.address();
    data.colours = meshes_[size_t(object.mesh)].colours.address();
    data.dielectric = dielectricReflectance(material);
    const bool same = readsMaterialAtLitUvs(mesh);
    const glm::ivec2 size(gpuMaterial.size), emissiveSize(gpuMaterial.emissiveSize);
    data.litSize = same ? tsl::lumelGrid(size, emissiveSize) : tsl::lumelGrid(mesh, size, emissiveSize);
    data.materialLevelOffset = levelOfLumels(gpuMaterial.size, data.litSize);
    data.emissiveLevelOffset = levelOfLumels(gpuMaterial.emissiveSize, data.litSize);
    data.flags = material.doubleSided ? shared::kObjectDoubleSided : 0u;
    if (material.unlit)
        data.flags |= shared::kObjectUnlit;
    if (!same)
        data.flags |= shared::kObjectOwnMaterialUv;
    data.alphaCutoff = material.alphaCutoff;
    if (material.alphaMode == scene::AlphaMode::mask)
        data.flags |= shared::kObjectMask;
    if (mesh.uvProblem.empty() && material.alphaMode == scene::AlphaMode::opaque) {
        data.flags |= shared::kObjectLightable;
        result.texelMap = texelMapFor(device, scene, object.mesh, data.litSize);
        data.texels = result.texelMap->buffer.address();
        for (uint32_t i = 0; i < shared::kMaxLevels; ++i)
            data.texelOffsets[i] = result.texelMap->map.offsets[i];
    }
    objects_.push_back(result);
    takeShape(objects_.back());
    moveObject(objects_.size() - 1, object.worldFromObject, 0);
}

void GpuScene::writeObjects()
{
    auto* table = objectTable_.mapped<shared::Object>();
    for (size_t i = 0; i < objects_.size(); ++i)
        table[i] = objects_[i].data;
}

void GpuScene::writeObjects(const tsl::Residency& residency, const LitPool& pool,
                            const std::vector<ObjectJobs>& jobs)
{
    writeObjects();
    auto* table = objectTable_.mapped<shared::Object>();
    for (size_t i = 0; i < objects_.size(); ++i) {
        const tsl::ObjectResidency& resident = residency.objects()[i];
        if (!resident.texture)
            continue;
        const LitBlock& block = pool.block(resident.texture);
        shared::Object& object = table[i];
        object.mips = block.layout.mips;
        object.layer = resident.texture.layer;
        object.litLevel = resident.litLevel;
        object.finest = resident.finest;
        object.lightJob = jobs[i].light;
        object.lowerJob = jobs[i].lower;
        std::copy(block.layout.tileOffsets.begin(), block.layout.tileOffsets.end(), object.tileOffsets);
        object.tiles = block.states.address() + block.stateOffset(resident.texture.layer);
    }
}

std::vector<uint8_t> GpuScene::objectsInView(const glm::mat4& clipFromWorld) const
{
    std::vector<uint8_t> inView(objects_.size(), 0);
    for (size_t i = 0; i < objects_.size(); ++i) {
        const glm::mat4 clipFromObject = clipFromWorld * objects_[i].data.worldFromObject;
        const Bounds& box = objects_[i].bounds;
        // Out of view when all eight corners lie outside the same plane. Planes: left, right, bottom, top,
        // near (reversed depth: z <= w); infinity has no far plane.
        std::array<int, 5> outside{};
        for (int corner = 0; corner < 8; ++corner) {
            const glm::vec4 clip = clipFromObject * glm::vec4(box.corner(corner), 1.0f);
            outside[0] += clip.x < -clip.w;
            outside[1] += clip.x > clip.w;
            outside[2] += clip.y < -clip.w;
            outside[3] += clip.y > clip.w;
            outside[4] += clip.z > clip.w;
        }
        inView[i] = std::none_of(outside.begin(), outside.end(), [](int n) { return n == 8; });
    }
    return inView;
}

void GpuScene::drawTriangles(vk::CommandBuffer commands, size_t object) const
{
    const GpuObject& o = objects_[object];
    commands.setCullMode(o.data.flags & shared::kObjectDoubleSided ? vk::CullModeFlagBits::eNone
                                                                   : vk::CullModeFlagBits::eBack);
    commands.setFrontFace(o.mirrored ? vk::FrontFace::eClockwise : vk::FrontFace::eCounterClockwise);
    // Indexed, so that a vertex which triangles share is transformed once.
    commands.bindIndexBuffer(o.indices, 0, vk::IndexType::eUint32);
    commands.bindVertexBuffers(0, {o.vertices, objectTable_.handle()}, {0, 0});
    commands.drawIndexed(o.indexCount, 1, 0, 0, uint32_t(object));
}

} // namespace lumel
