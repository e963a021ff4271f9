#include "material_resources.h"
#include "gpu/sampler.h"
#include "upload.h"
#include <array>

namespace lumel {
namespace {

constexpr size_t kMaps = 8; // of a material

// By scene::Wrap.
constexpr std::array kAddressModes = {vk::SamplerAddressMode::eRepeat,
                                      vk::SamplerAddressMode::eMirroredRepeat,
                                      vk::SamplerAddressMode::eClampToEdge};

} // namespace

uint32_t materialFeatures(const GpuMaterial& material)
{
    const auto feature = [](const gpu::Image& map, uint32_t bit) {
        return map.extent() == vk::Extent2D{1, 1} ? bit : 0u;
    };
    return feature(material.emissive, shared::kFeatureConstantEmission) |
           feature(material.opacity, shared::kFeatureConstantOpacity) |
           feature(material.base, shared::kFeatureConstantBase) |
           (material.second ? shared::kFeatureSecondLobe : 0u);
}

MaterialResources::MaterialResources(const gpu::Device& device, const scene::Scene& scene,
                                     const std::vector<scene::BakedMaterial>& baked)
    : layout_(gpu::makeSetLayout(
          device, std::vector<vk::DescriptorType>(kMaps, vk::DescriptorType::eCombinedImageSampler))),
      pool_(gpu::makeSamplerPool(device, baked.size(), kMaps))
{
    for (const auto v : kAddressModes)
        for (const auto u : kAddressModes)
            samplers_.push_back(gpu::makeSampler(device, {.u = u, .v = v, .mips = true}));
    materials_.resize(baked.size()); // before the batch: it must not outlive what it fills
    gpu::UploadBatch batch(device);
    for (size_t i = 0; i < baked.size(); ++i)
        upload(device, batch, baked[i], scene.materials[i], materials_[i]);
    batch.finish();
}

void MaterialResources::replace(const gpu::Device& device, size_t material, const scene::Reflectance& before,
                                const scene::Reflectance& after)
{
    const GpuMaterial& maps = materials_[material];
    gpu::UploadBatch batch(device);
    const scene::FirstLobeMaps old = scene::firstLobeMaps(before), now = scene::firstLobeMaps(after);
    refillChain(batch, maps.normal, old.normal, now.normal);
    refillChain(batch, maps.specular, old.specular, now.specular);
    refillChain(batch, maps.diffuse, before.diffuse, after.diffuse);
    refillChain(batch, maps.base, before.base, after.base);
    if (maps.second) {
        refillChain(batch, maps.second, before.second, after.second);
        refillChain(batch, maps.secondSpecular, before.secondSpecular, after.secondSpecular);
    }
    batch.finish();
}

vk::Sampler MaterialResources::samplerOf(const scene::UvMapping& uv) const
{
    return *samplers_[size_t(uv.wrapU) + kAddressModes.size() * size_t(uv.wrapV)];
}

void MaterialResources::upload(const gpu::Device& device, gpu::UploadBatch& batch,
                               const scene::BakedMaterial& baked, const scene::Material& source,
                               GpuMaterial& material) const
{
    const auto image = [&](const scene::HalfChain& chain, const char* what) {
        return uploadChain(batch, chain, source.name + what);
    };
    const scene::FirstLobeMaps first = scene::firstLobeMaps(baked.reflectance);
    material.normal = image(first.normal, " normal");
    material.specular = image(first.specular, " specular");
    material.diffuse = image(baked.reflectance.diffuse, " diffuse");
    material.emissive = image(baked.emissive, " emissive");
    material.opacity = image(baked.opacity, " opacity");
    material.base = image(baked.reflectance.base, " base");
    if (baked.reflectance.hasSecond()) {
        material.second = image(baked.reflectance.second, " second lobe");
        material.secondSpecular = image(baked.reflectance.secondSpecular, " second specular");
    }
    material.set = gpu::makeSet(device, pool_, layout_);
    uint32_t binding = 0;
    for (const gpu::Image* map : {&material.normal, &material.specular, &material.diffuse, &material.emissive,
                                  &material.opacity, &material.base,
                                  // Nothing reads these of a material of one lobe.
                                  material.second ? &material.second : &material.normal,
                                  material.second ? &material.secondSpecular : &material.specular})
        gpu::writeSampled(device, *material.set, binding++,
                          samplerOf(map == &material.emissive ? source.emissionUv : source.uv), map->view());
}

} // namespace lumel
