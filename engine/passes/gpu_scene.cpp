#include "gpu_scene.h"
#include "core/image.h"
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
    : materialLayout_(gpu::makeSetLayout(
          device, std::vector<vk::DescriptorType>(5, vk::DescriptorType::eCombinedImageSampler))),
      sampler_(device.handle(), {.magFilter = vk::Filter::eLinear,
                                 .minFilter = vk::Filter::eLinear,
                                 .mipmapMode = vk::SamplerMipmapMode::eLinear,
                                 .addressModeU = vk::SamplerAddressMode::eRepeat,
                                 .addressModeV = vk::SamplerAddressMode::eRepeat,
                                 .maxLod = VK_LOD_CLAMP_NONE})
{
    for (const scene::Mesh& mesh : scene.meshes)
        meshes_.push_back({gpu::uploadBuffer(device, mesh.vertices, mesh.name + " vertices"),
                           gpu::uploadBuffer(device, mesh.indices, mesh.name + " indices")});
    materials_.reserve(materials.size()); // sets point into it
    for (size_t i = 0; i < materials.size(); ++i)
        uploadMaterial(device, materials[i], scene.materials[i].name);
    uploadLights(device, scene);
    for (const scene::Object& object : scene.objects)
        addObject(device, scene, object);
    objectTable_ =
        gpu::Buffer(device, objects_.size() * sizeof(shared::Object), gpu::Buffer::Home::host, "objects");
}

void GpuScene::uploadMaterial(const gpu::Device& device, const scene::BakedMaterial& baked,
                              const std::string& name)
{
    using enum baker::Channel;
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
    material.set = gpu::makeSet(device, materialLayout_);
    uint32_t binding = 0;
    for (const gpu::Image* image :
         {&material.normal, &material.specular, &material.diffuse, &material.glow, &material.opacity})
        gpu::writeSampled(device, *material.set, binding++, *sampler_, image->view());
    materials_.push_back(std::move(material));
}

void GpuScene::uploadLights(const gpu::Device& device, const scene::Scene& scene)
{
    std::vector<shared::Light> lights;
    const auto source = scene.lights.empty() ? scene::threeLightRig() : scene.lights;
    for (const scene::Light& light : source)
        lights.push_back(packLight(light));
    lightCount_ = uint32_t(lights.size());
    lights_ = gpu::uploadBuffer(device, lights, "lights");
    // A little fill, so that what no light reaches is dim, not black: a sky whose radiance is 4 % of the
    // brightest directional light's irradiance, a third of that from below.
    float brightest = 0.0f;
    for (const scene::Light& light : source)
        if (light.type == scene::LightType::directional)
            brightest = std::max(brightest, light.intensity);
    sky_ = glm::vec3(0.04f * brightest);
    ground_ = sky_ / 3.0f;
}

const GpuTexelMap* GpuScene::texelMapFor(const gpu::Device& device, const scene::Scene& scene, int mesh,
                                         glm::uvec2 grid)
{
    auto& slot = texelMaps_[{mesh, grid.x, grid.y}];
    if (!slot) {
        slot = std::make_unique<GpuTexelMap>();
        slot->map = tsl::makeTexelMap(scene.meshes[size_t(mesh)], grid);
        for (uint32_t level = 0; level < slot->map.levels; ++level)
            slot->tiles.push_back(tsl::occupiedTiles(slot->map, level));
        slot->buffer = gpu::uploadBuffer(device, slot->map.texels, "texel map");
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
    result.indexCount = uint32_t(mesh.indices.size());
    result.bounds = mesh.bounds;
    result.blend = material.alphaMode == scene::AlphaMode::blend;
    result.mirrored = glm::determinant(glm::mat3(object.worldFromObject)) < 0.0f;

    shared::Object& data = result.data;
    data = {};
    data.worldFromObject = object.worldFromObject;
    data.worldFromObjectNormal = glm::transpose(glm::inverse(glm::mat3(object.worldFromObject)));
    data.vertices = meshes_[size_t(object.mesh)].vertices.address();
    data.indices = meshes_[size_t(object.mesh)].indices.address();
    data.litSize = tsl::lumelGrid(int(gpuMaterial.size.x), int(gpuMaterial.size.y));
    data.materialLevelOffset = std::log2(float(gpuMaterial.size.x) / float(data.litSize.x));
    data.texelsCoincide = gpuMaterial.size * (data.litSize / gpuMaterial.size) == data.litSize &&
                          data.litSize.x / gpuMaterial.size.x == data.litSize.y / gpuMaterial.size.y;
    data.flags = material.doubleSided ? shared::kObjectDoubleSided : 0u;
    data.alphaCutoff = material.alphaCutoff;
    if (material.alphaMode == scene::AlphaMode::mask)
        data.flags |= shared::kObjectMask;
    if (mesh.uvProblem.empty() && material.alphaMode == scene::AlphaMode::opaque) {
        result.texelMap = texelMapFor(device, scene, object.mesh, data.litSize);
        data.texels = result.texelMap->buffer.address();
        for (uint32_t i = 0; i < shared::kMaxLevels; ++i)
            data.texelOffsets[i] = result.texelMap->map.offsets[i];
    }
    objects_.push_back(result);
}

void GpuScene::writeObjects(const tsl::Room& room)
{
    auto* table = objectTable_.mapped<shared::Object>();
    for (size_t i = 0; i < objects_.size(); ++i) {
        table[i] = objects_[i].data;
        if (i < room.objects.size())
            table[i].litLevel = room.objects[i].litLevel;
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

void GpuScene::drawTriangles(vk::CommandBuffer commands, size_t object) const
{
    const GpuObject& o = objects_[object];
    commands.setCullMode(o.data.flags & shared::kObjectDoubleSided ? vk::CullModeFlagBits::eNone
                                                                   : vk::CullModeFlagBits::eBack);
    commands.setFrontFace(o.mirrored ? vk::FrontFace::eClockwise : vk::FrontFace::eCounterClockwise);
    commands.draw(o.indexCount, 1, 0, 0);
}

} // namespace lumel
