// A scene's materials on the GPU, baked by one method. All renderers that show this bake share them, and
// whatever replaces a placeholder.
#pragma once
#include "gpu/pipeline.h"
#include "gpu/upload.h"
#include "scene/materials.h"

namespace lumel {

struct GpuMaterial {
    std::string name;
    vk::Sampler sampler; // of all but emission
    gpu::Image normal, specular, diffuse, emissive, opacity;
    gpu::Image base;                   // mean F0 and roughness of level 0
    gpu::Image second, secondSpecular; // none in a material of one lobe
    vk::raii::DescriptorSet set = nullptr;
};

// kFeature... of a material: which maps are one texel, and whether there are second lobes.
uint32_t materialFeatures(const GpuMaterial& material);

class MaterialResources {
public:
    MaterialResources(const gpu::Device& device, const scene::Scene& scene,
                      const std::vector<scene::BakedMaterial>& baked);

    const std::vector<GpuMaterial>& all() const { return materials_; } // in the scene's order
    // Fills a material's maps with what it reflects now, in place of `before`: of the same sizes, with second
    // lobes or without. Frames in flight still see that; the others follow
    // Renderer::changeMaterial(). Throws Error, and has changed nothing, where second lobes do not fit into
    // memory.
    void replace(const gpu::Device& device, size_t material, const scene::Reflectance& before,
                 const scene::Reflectance& after);
    // Of all their sets.
    const gpu::SetLayout& layout() const { return layout_; }

private:
    void upload(const gpu::Device& device, gpu::UploadBatch& batch, const scene::BakedMaterial& baked,
                const scene::Material& source, GpuMaterial& material) const;
    static void writeSecondLobes(const gpu::Device& device, const GpuMaterial& material);
    vk::Sampler samplerOf(const scene::UvMapping& uv) const;

    gpu::SetLayout layout_;
    vk::raii::DescriptorPool pool_;
    std::vector<vk::raii::Sampler> samplers_; // by wrapU + 3 wrapV
    std::vector<GpuMaterial> materials_;
};

} // namespace lumel
