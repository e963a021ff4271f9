#include "inspection.h"
#include "scene/material_maps.h"

namespace lumel::ui {

// Decoding a material's images again for each texel would take longer.
struct Inspector::Maps {
    Maps(const scene::Scene& scene, size_t index)
        : inspector(scene::reflectanceMaps(scene, scene.materials[index])), material(index)
    {
    }
    baker::TexelInspector inspector;
    size_t material;
};

Inspector::~Inspector()
{
    if (thread_.joinable())
        thread_.join();
}

void Inspector::look(std::shared_ptr<const scene::Scene> scene,
                     std::shared_ptr<const std::vector<scene::BakedMaterial>> baked, const Texel& texel)
{
    if (thread_.joinable() || (last_ == texel && lastScene_ == baked.get()))
        return;
    if (lastScene_ != baked.get())
        maps_.reset();
    last_ = texel;
    lastScene_ = baked.get();
    done_ = false;
    thread_ = std::thread([this, scene, baked, texel] {
        result_ = {};
        try {
            work(*scene, *baked, texel);
        } catch (const std::exception&) { // maps that cannot be read: there is nothing to show
            result_ = {};
        }
        done_ = true;
    });
}

bool Inspector::take(Inspection& inspection)
{
    if (!done_)
        return false;
    thread_.join();
    done_ = false;
    inspection = result_;
    return true;
}

void Inspector::work(const scene::Scene& scene, const std::vector<scene::BakedMaterial>& baked,
                     const Texel& texel)
{
    if (!maps_ || maps_->material != texel.material)
        maps_ = std::make_shared<Maps>(scene, texel.material);
    const scene::Reflectance& reflectance = baked[texel.material].reflectance;
    const auto level = size_t(texel.level);
    std::vector<baker::Level> sizes;
    for (size_t i = 0; i < reflectance.levels(); ++i) {
        const glm::ivec2 size = reflectance.normal.size(i);
        sizes.push_back({.width = size.x, .height = size.y, .texels = {}, .second = {}});
    }
    result_.baked = reflectance.at(level, texel.x, texel.y);
    const auto second = reflectance.secondAt(level, texel.x, texel.y);
    static_cast<baker::TexelLobes&>(result_) =
        maps_->inspector.look(sizes, level, texel.x, texel.y, result_.baked.data(), second.data());
    result_.texel = texel;
    result_.material = scene.materials[texel.material].name;
    result_.width = sizes[level].width;
    result_.height = sizes[level].height;
    result_.valid = true;
}

} // namespace lumel::ui
