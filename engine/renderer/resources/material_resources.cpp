#include "material_resources.h"
#include "gpu/sampler.h"
#include "upload.h"
#include <array>

namespace lumel {
namespace {

constexpr size_t kMaps = 8; // of a material; those of second lobes are the last

// Maps of second lobes, where there are any.
struct SecondLobeMaps {
    gpu::Image second, specular;
};

SecondLobeMaps uploadSecondLobes(gpu::UploadBatch& batch, const scene::Reflectance& reflectance,
                                 const std::string& name)
{
    if (!reflectance.hasSecond())
        return {};
    return {uploadChain(batch, reflectance.second, name + " second lobe"),
            uploadChain(batch, reflectance.secondSpecular, name + " second specular")};
}

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
      pool_(gpu::makePool(device, vk::DescriptorType::eCombinedImageSampler, baked.size(), kMaps))
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
    GpuMaterial& maps = materials_[material];
    const bool keepsSecond = before.second.size() == after.second.size();
    SecondLobeMaps second; // before the batch: it must not outlive what it fills
    gpu::UploadBatch batch(device);
    if (!keepsSecond)
        second = uploadSecondLobes(batch, after, maps.name);
    // Beside second lobes, first ones are stored in another way.
    const auto old = keepsSecond ? scene::firstLobeMaps(before) : scene::FirstLobeMaps();
    const auto now = scene::firstLobeMaps(after);
    refillChain(batch, maps.normal, old.normal, now.normal);
    refillChain(batch, maps.specular, old.specular, now.specular);
    refillChain(batch, maps.diffuse, before.diffuse, after.diffuse);
    refillChain(batch, maps.base, before.base, after.base);
    if (keepsSecond && maps.second) {
        refillChain(batch, maps.second, before.second, after.second);
        refillChain(batch, maps.secondSpecular, before.secondSpecular, after.secondSpecular);
    }
    batch.finish();
    if (keepsSecond)
        return;
    // No frame uses the set: the batch was submitted after all of them, and has finished.
    maps.second = std::move(second.second);
    maps.secondSpecular = std::move(second.specular);
    writeSecondLobes(device, maps);
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
    material.name = source.name;
    material.sampler = samplerOf(source.uv);
    material.normal = image(first.normal, " normal");
    material.specular = image(first.specular, " specular");
    material.diffuse = image(baked.reflectance.diffuse, " diffuse");
    material.emissive = image(baked.emissive, " emissive");
    material.opacity = image(baked.opacity, " opacity");
    material.base = image(baked.reflectance.base, " base");
    SecondLobeMaps second = uploadSecondLobes(batch, baked.reflectance, source.name);
    material.second = std::move(second.second);
    material.secondSpecular = std::move(second.specular);
    material.set = gpu::makeSet(device, pool_, layout_);
    uint32_t binding = 0;
    for (const gpu::Image* map : {&material.normal, &material.specular, &material.diffuse, &material.emissive,
                                  &material.opacity, &material.base})
        gpu::writeSampled(device, *material.set, binding++,
                          map == &material.emissive ? samplerOf(source.emissionUv) : material.sampler,
                          map->view());
    writeSecondLobes(device, material);
}

// Nothing reads these of a material of one lobe.
void MaterialResources::writeSecondLobes(const gpu::Device& device, const GpuMaterial& material)
{
    const bool two = bool(material.second);
    uint32_t binding = kMaps - 2;
    for (const gpu::Image* map :
         {two ? &material.second : &material.normal, two ? &material.secondSpecular : &material.specular})
        gpu::writeSampled(device, *material.set, binding++, material.sampler, map->view());
}

} // namespace lumel
