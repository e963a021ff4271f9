#include "gpu_scene.h"
#include "core/error.h"
#include "core/image.h"
#include "lit_pool.h"
#include "scene/environment.h"
#include "scene/material_maps.h"
#include "shared/shading.h"
#include <fmt/format.h>
#include <glm/gtc/packing.hpp>
#include <tbb/parallel_for.h>

namespace lumel {
namespace {

using baker::kChannels;
using HalfLevels = std::vector<std::vector<uint16_t>>;

// Four channels of every level, packed to half floats.
HalfLevels packLevels(const baker::ReflectanceMips& mips, std::array<baker::Channel, 4> channels)
{
    HalfLevels packed;
    for (const baker::Level& level : mips.levels) {
        const size_t count = size_t(level.width) * level.height;
        std::vector<uint16_t> halves(count * 4);
        tbb::parallel_for(tbb::blocked_range<size_t>(0, count, 65536), [&](const auto& range) {
            std::vector<float> row(range.size() * 4);
            for (size_t i = range.begin(); i < range.end(); ++i)
                for (size_t c = 0; c < 4; ++c)
                    row[(i - range.begin()) * 4 + c] = level.texels[i * kChannels + size_t(channels[c])];
            floatsToHalf(row, halves.data() + range.begin() * 4);
        });
        packed.push_back(std::move(halves));
    }
    return packed;
}

gpu::Image uploadChain(const gpu::Device& device, const std::vector<Image>& chain, const std::string& name)
{
    HalfLevels packed;
    for (const Image& image : chain) {
        const size_t count = size_t(image.width) * image.height;
        std::vector<float> rgba(count * 4, 1.0f);
        for (size_t i = 0; i < count; ++i)
            std::copy_n(image.pixels.data() + i * size_t(image.channels), image.channels,
                        rgba.data() + i * 4);
        packed.emplace_back(rgba.size());
        floatsToHalf(rgba, packed.back().data());
    }
    return gpu::uploadHalfImage(device, uint32_t(chain.front().width), uint32_t(chain.front().height), packed,
                                name);
}

// By scene::Wrap.
constexpr std::array kAddressModes = {vk::SamplerAddressMode::eRepeat,
                                      vk::SamplerAddressMode::eMirroredRepeat,
                                      vk::SamplerAddressMode::eClampToEdge};

bool readsMaterialAtLitUvs(const scene::Mesh& mesh)
{
    return std::all_of(mesh.vertices.begin(), mesh.vertices.end(),
                       [](const shared::Vertex& v) { return v.materialUv == v.uv && v.glowUv == v.uv; });
}

// log2 of how much longer glow UVs are than the others; 0 where they are the same or nothing is known.
float glowLevelOffset(const scene::Mesh& mesh)
{
    double glow = 0.0, own = 0.0; // twice the areas
    const auto area = [](glm::dvec2 a, glm::dvec2 b, glm::dvec2 c) {
        return std::abs((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x));
    };
    for (size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        const auto &a = mesh.vertices[mesh.indices[i]], &b = mesh.vertices[mesh.indices[i + 1]],
                   &c = mesh.vertices[mesh.indices[i + 2]];
        glow += area(a.glowUv, b.glowUv, c.glowUv);
        own += area(a.materialUv, b.materialUv, c.materialUv);
    }
    return glow > 0.0 && own > 0.0 ? float(0.5 * std::log2(glow / own)) : 0.0f;
}

gpu::Buffer uploadColours(const gpu::Device& device, const scene::Mesh& mesh)
{
    if (mesh.colours.empty())
        return {};
    std::vector<glm::uvec2> packed;
    for (const glm::vec4& c : mesh.colours)
        packed.emplace_back(glm::packHalf2x16({c.r, c.g}), glm::packHalf2x16({c.b, c.a}));
    return gpu::uploadBuffer(device, packed, mesh.name + " colours");
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

shared::Light packLight(const scene::Light& light)
{
    shared::Light packed{};
    packed.type = uint32_t(light.type);
    packed.position = light.position;
    packed.direction = light.direction;
    packed.inverseRange = light.range > 0.0f ? 1.0f / light.range : 0.0f;
    packed.intensity = light.colour * light.intensity;
    // KHR_lights_punctual, "Inner and Outer Cone Angles": the reference's scale and offset.
    const float outer = std::cos(light.outerCone), inner = std::cos(light.innerCone);
    packed.coneScale = 1.0f / std::max(0.001f, inner - outer);
    packed.coneOffset = -outer * packed.coneScale;
    return packed;
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
    objectTable_ =
        gpu::Buffer(device, objects_.size() * sizeof(shared::Object), gpu::Buffer::Home::host, "objects");
}

void GpuScene::uploadMaterial(const gpu::Device& device, const scene::BakedMaterial& baked,
                              const scene::Material& source)
{
    using enum baker::Channel;
    const std::string& name = source.name;
    const auto& mips = baked.reflectance;
    const auto width = uint32_t(mips.levels.front().width), height = uint32_t(mips.levels.front().height);
    const auto upload = [&](std::array<baker::Channel, 4> channels, const char* what) {
        return gpu::uploadHalfImage(device, width, height, packLevels(mips, channels), name + what);
    };
    GpuMaterial material;
    material.size = {width, height};
    material.normal = upload({kNx, kNy, kSxx, kSyy}, " normal");
    material.specular = upload({kKsR, kKsG, kKsB, kSxy}, " specular");
    material.diffuse = upload({kKdR, kKdG, kKdB, kError}, " diffuse");
    material.glow = uploadChain(device, baked.glow, name + " glow");
    material.opacity = uploadChain(device, baked.opacity, name + " opacity");
    material.albedo = uploadChain(device, scene::meanSpecular(mips), name + " albedo");
    material.set = gpu::makeSet(device, materialLayout_);
    uint32_t binding = 0;
    for (const gpu::Image* image : {&material.normal, &material.specular, &material.diffuse, &material.glow,
                                    &material.opacity, &material.albedo})
        gpu::writeSampled(device, *material.set, binding++,
                          samplerOf(image == &material.glow ? source.glowUv : source.uv), image->view());
    materials_.push_back(std::move(material));
}

void GpuScene::makeFrameSet(const gpu::Device& device)
{
    using Home = gpu::Buffer::Home;
    view_ = gpu::Buffer(device, sizeof(shared::View), Home::host, "view");
    lights_ = gpu::Buffer(device, shared::kMaxLights * sizeof(shared::Light), Home::host, "lights");
    frameSet_ = gpu::makeSet(device, frameLayout_);
    gpu::writeUniform(device, *frameSet_, 0, view_.handle());
    gpu::writeUniform(device, *frameSet_, 1, lights_.handle());
}

void GpuScene::touchAll(uint32_t frame)
{
    changed_ = frame;
    for (GpuObject& object : objects_)
        object.data.changed = frame;
}

void GpuScene::setEnvironment(const gpu::Device& device,
                              std::shared_ptr<const scene::Environment> environment, uint32_t frame)
{
    environment_ = std::move(environment);
    const std::vector<Image> black = {Image(1, 1, 3)};
    environmentMap_ = uploadChain(device, environment_ ? environment_->levels : black, "environment");
    gpu::writeSampled(device, *frameSet_, 2, *samplers_.back(), environmentMap_.view()); // clamped
    const shared::EnvironmentView before = std::exchange(environmentView_, {});
    adjustEnvironment(before.intensity, glm::degrees(std::atan2(before.turn.y, before.turn.x)), frame);
    touchAll(frame);
}

void GpuScene::adjustEnvironment(float intensity, float degrees, uint32_t frame)
{
    shared::EnvironmentView view{.diffuse = {},
                                 .intensity = intensity,
                                 .turn = {std::cos(glm::radians(degrees)), std::sin(glm::radians(degrees))}};
    for (size_t i = 0; environment_ && i < environment_->diffuse.size(); ++i)
        view.diffuse[i] = environment_->diffuse[i] * intensity;
    if (std::memcmp(&view, &environmentView_, sizeof(view)) == 0)
        return;
    environmentView_ = view;
    touchAll(frame);
}

void GpuScene::bindShadows(const gpu::Device& device, vk::Sampler sampler, vk::ImageView maps)
{
    gpu::writeSampled(device, *frameSet_, 3, sampler, maps);
}

void GpuScene::setShadows(const std::vector<shared::Shadow>& shadows, uint32_t frame)
{
    // A light that got or lost its map is another for all that it reaches.
    const auto touchMissing = [&](const auto& from, const auto& in) {
        for (const shared::Shadow& shadow : from)
            if (shadow.light < lightCount_ &&
                std::ranges::none_of(in, [&](const auto& s) { return s.light == shadow.light; }))
                touchLight(shadow.light, frame);
    };
    touchMissing(shadows_, shadows);
    touchMissing(shadows, shadows_);
    shadows_ = shadows;
}

// A little fill, so that what no light reaches is dim, not black: a sky whose radiance is 4 % of the
// brightest directional light's irradiance, a third of that from below.
void GpuScene::setSky(const std::vector<scene::Light>& lights, uint32_t frame)
{
    float brightest = 0.0f;
    for (const scene::Light& light : lights)
        if (light.type == scene::LightType::directional)
            brightest = std::max(brightest, light.intensity);
    const glm::vec3 sky(0.04f * brightest);
    if (sky == sky_)
        return;
    sky_ = sky;
    ground_ = sky_ / 3.0f;
    touchAll(frame);
}

void GpuScene::setLights(const std::vector<scene::Light>& lights, uint32_t frame)
{
    if (lights.size() > shared::kMaxLights)
        throw Error(fmt::format("the scene has {} lights, the limit is {}; remove some", lights.size(),
                                shared::kMaxLights));
    auto* table = lights_.mapped<shared::Light>();
    const bool recount = lights.size() != lightCount_;
    for (size_t i = 0; i < lights.size(); ++i) {
        shared::Light light = packLight(lights[i]);
        light.changed = table[i].changed;
        if (recount || std::memcmp(&light, &table[i], sizeof(light)) != 0) {
            light.changed = changed_ = frame;
            table[i] = light;
        }
    }
    lightCount_ = uint32_t(lights.size());
    setSky(lights, frame);
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

void GpuScene::bend(const scene::Shapes& shapes, uint32_t frame)
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
    // What glows all over stands for a light, and would shade it.
    const bool glows = material.unlit || (material.emissive != glm::vec3(0.0f) && material.emissiveImage < 0);
    result.casts = !result.blend && !glows;

    shared::Object& data = result.data;
    data = {};
    data.vertices = object.deformed >= 0 ? deformed_.items()[size_t(object.deformed)].vertices.address()
                                         : meshes_[size_t(object.mesh)].vertices.address();
    data.indices = meshes_[size_t(object.mesh)].indices.address();
    data.colours = meshes_[size_t(object.mesh)].colours.address();
    data.dielectric = dielectricReflectance(material);
    const bool same = readsMaterialAtLitUvs(mesh);
    const int width = int(gpuMaterial.size.x), height = int(gpuMaterial.size.y);
    data.litSize = same ? tsl::lumelGrid(width, height) : tsl::lumelGrid(mesh, width, height);
    data.materialLevelOffset = std::log2(float(gpuMaterial.size.x) / float(data.litSize.x));
    data.glowLevelOffset = same ? 0.0f : glowLevelOffset(mesh);
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

void GpuScene::writeObjects(const tsl::Rooms& rooms, const LitPool& pool, const std::vector<ObjectJobs>& jobs)
{
    writeObjects();
    auto* table = objectTable_.mapped<shared::Object>();
    for (size_t i = 0; i < objects_.size(); ++i) {
        const tsl::ObjectRoom& room = rooms.objects()[i];
        if (!room.texture)
            continue;
        const LitBlock& block = pool.block(room.texture);
        shared::Object& object = table[i];
        object.mips = block.layout.mips;
        object.layer = room.texture.layer;
        object.litLevel = room.litLevel;
        object.finest = room.finest;
        object.lightJob = jobs[i].light;
        object.lowerJob = jobs[i].lower;
        std::copy(block.layout.tileOffsets.begin(), block.layout.tileOffsets.end(), object.tileOffsets);
        object.tiles = block.states.address() + block.stateOffset(room.texture.layer);
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
            const glm::vec3 p(corner & 1 ? box.upper.x : box.lower.x, corner & 2 ? box.upper.y : box.lower.y,
                              corner & 4 ? box.upper.z : box.lower.z);
            const glm::vec4 clip = clipFromObject * glm::vec4(p, 1.0f);
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

std::array<uint32_t, shared::kListedLights / 32> GpuScene::lightsReaching(size_t object) const
{
    const GpuObject& o = objects_[object];
    const glm::mat4& m = o.data.worldFromObject;
    const glm::vec3 centre = m * glm::vec4(o.bounds.centre(), 1.0f);
    float radius = 0.0f; // to the farthest corner of the box
    for (int corner = 0; corner < 8; ++corner) {
        const glm::vec3 side((corner & 1) ? 1.0f : -1.0f, (corner & 2) ? 1.0f : -1.0f,
                             (corner & 4) ? 1.0f : -1.0f);
        radius =
            std::max(radius, glm::length(glm::mat3(m) * (0.5f * side * (o.bounds.upper - o.bounds.lower))));
    }
    const auto* lights = lights_.mapped<const shared::Light>();
    std::array<uint32_t, shared::kListedLights / 32> listed{};
    for (uint32_t i = 0; i < std::min(lightCount_, shared::kListedLights); ++i)
        if (shared::lightReaches(lights[i], centre, radius))
            listed[i / 32] |= 1u << i % 32;
    return listed;
}

bool GpuScene::changedIn(size_t object, uint32_t frame) const
{
    if (objects_[object].data.changed >= frame)
        return true;
    const auto reaching = lightsReaching(object);
    const auto* lights = lights_.mapped<const shared::Light>();
    for (uint32_t i = 0; i < lightCount_; ++i)
        if (lights[i].changed >= frame && (i >= shared::kListedLights || (reaching[i / 32] >> i % 32 & 1u)))
            return true;
    return false;
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
