// The materials of the viewer's renderers: by filter, as placeholders and as baked.
#include "core/error.h"
#include "renderers.h"
#include <spdlog/spdlog.h>

namespace lumel {
namespace {

bool sameSizes(const scene::Reflectance& a, const scene::Reflectance& b)
{
    return a.size() == b.size() && a.base.size() == b.base.size();
}

} // namespace

std::shared_ptr<const std::vector<scene::BakedMaterial>> ViewRenderers::materials(baker::Method method) const
{
    const std::lock_guard lock(materialsMutex_);
    const auto found = materials_.find(method);
    return found == materials_.end() ? nullptr : found->second.baked;
}

void ViewRenderers::addMaterials(scene::LoadedScene loaded)
{
    const baker::Method method = loaded.options.method;
    const auto known = materials_.find(method);
    if (known != materials_.end()) {
        std::vector<scene::FinishedBake> bakes;
        for (const size_t material : known->second.placeholders)
            if (!loaded.placeholders.contains(material))
                bakes.push_back({{material}, (*loaded.materials)[material].reflectance});
        replace(method, bakes);
        return;
    }
    const std::lock_guard lock(materialsMutex_);
    materials_[method] = {.baked = loaded.materials,
                          .placeholders = loaded.placeholders,
                          .options = loaded.options,
                          .uploaded = {}};
}

void ViewRenderers::replace(baker::Method method, const std::vector<scene::FinishedBake>& bakes)
{
    const auto known = materials_.find(method);
    if (known == materials_.end()) // no longer asked for
        return;
    for (const scene::FinishedBake& finished : bakes)
        for (const size_t material : finished.materials)
            replace(known->second, method, material, finished.reflectance);
}

void ViewRenderers::replace(Bake& bake, baker::Method method, size_t material,
                            const scene::Reflectance& reflectance)
{
    const bool fits = upload(bake, material, reflectance);
    {
        auto baked = std::make_shared<std::vector<scene::BakedMaterial>>(*bake.baked); // share their texels
        if (fits)
            (*baked)[material].reflectance = reflectance;
        const std::lock_guard lock(materialsMutex_);
        bake.baked = std::move(baked);
        bake.placeholders.erase(material);
    }
    if (!bake.uploaded || !fits)
        return;
    for (Slot& slot : slots_)
        if (slot.renderer && slot.method == method) {
            slot.renderer->changeMaterial(material);
            if (slot.exact)
                slot.exact->changeMaterial(material);
            slot.metered.reset();
            // A picture of full quality is followed by another.
            slot.stale = slot.stale || !slot.isExact;
            slot.isExact = false;
        }
}

// What is shown, if anything. False, and the material stays as it is, where it does not fit into memory.
bool ViewRenderers::upload(const Bake& bake, size_t material, const scene::Reflectance& reflectance)
{
    try {
        if (bake.uploaded)
            bake.uploaded->replace(device_, material, (*bake.baked)[material].reflectance, reflectance);
        return true;
    } catch (const Error& e) {
        spdlog::warn("material '{}' stays as it is shown: {}", scene_->materials[material].name, e.what());
        return false;
    }
}

// Once a side shows what it is to show: what it will need later compiles after what it needed first.
void ViewRenderers::expectSecondLobes(Slot& slot, Shading shading)
{
    if (!slot.rendered || slot.renderer->settings().shading != shading || std::exchange(slot.expects, true))
        return;
    const Bake& bake = materials_.at(slot.method);
    if (slot.method == baker::Method::fit && bake.options.lobes != baker::LobeCount::one)
        slot.renderer->expectSecondLobes(bake.placeholders);
}

bool ViewRenderers::setMaterials(const scene::LoadedScene& loaded)
{
    const baker::Method method = loaded.options.method;
    const auto known = materials_.find(method);
    if (known == materials_.end() || !known->second.uploaded || loaded.scene->file != scene_->file)
        return false;
    const std::vector<scene::BakedMaterial>& before = *known->second.baked;
    if (!std::ranges::equal(before, *loaded.materials, sameSizes, &scene::BakedMaterial::reflectance,
                            &scene::BakedMaterial::reflectance) ||
        std::ranges::any_of(slots_, [&](const Slot& s) { return s.renderer && s.method != method; }))
        return false;
    std::vector<scene::FinishedBake> changed;
    for (size_t i = 0; i < before.size(); ++i)
        if (loaded.scene->materials[i].bakedFile != scene_->materials[i].bakedFile ||
            known->second.placeholders.contains(i) != loaded.placeholders.contains(i))
            changed.push_back({{i}, (*loaded.materials)[i].reflectance});
    replace(method, changed);
    scene_ = loaded.scene;
    const std::lock_guard lock(materialsMutex_);
    known->second.placeholders = loaded.placeholders;
    std::erase_if(materials_, [&](const auto& entry) { return entry.first != method; });
    return true;
}

void ViewRenderers::keepPlaceholders(baker::Method method)
{
    const std::lock_guard lock(materialsMutex_);
    if (const auto known = materials_.find(method); known != materials_.end())
        known->second.placeholders.clear();
}

SceneResources ViewRenderers::resourcesOf(baker::Method method)
{
    Bake& bake = materials_.at(method);
    if (!bake.uploaded)
        bake.uploaded = std::make_shared<MaterialResources>(device_, *scene_, *bake.baked);
    return {.geometry = geometry_, .materials = bake.uploaded, .environment = environment_};
}

// The first filter of a side that is `asked` for.
template<class Asked>
std::optional<baker::Method> ViewRenderers::firstOf(const ui::ViewState& state, const Asked& asked) const
{
    const std::lock_guard lock(materialsMutex_);
    for (size_t side = 0; side < (state.split ? 2u : 1u); ++side)
        if (state.sides[side].shading != Shading::reference &&
            asked(materials_.find(state.sides[side].filter)))
            return state.sides[side].filter;
    return std::nullopt;
}

std::optional<baker::Method> ViewRenderers::missing(const ui::ViewState& state) const
{
    return firstOf(state, [this](auto found) { return found == materials_.end(); });
}

std::optional<baker::Method> ViewRenderers::unfinished(const ui::ViewState& state) const
{
    return firstOf(state, [this](auto found) {
        return found != materials_.end() && !found->second.placeholders.empty();
    });
}

// The cache on disk has them too, and MIP chains take a hundred MiB per material.
void ViewRenderers::forgetUnused(const ui::ViewState& state)
{
    if (!state.split)
        slots_[1] = {};
    if (!state.split && !isReference_[0])
        slots_[kReference] = {};
    const auto used = [&](baker::Method method) {
        for (size_t side = 0; side < (state.split ? 2u : 1u); ++side)
            if (state.sides[side].filter == method || slots_[side].method == method)
                return true;
        return false;
    };
    if (missing(state))
        return;
    const std::lock_guard lock(materialsMutex_);
    std::erase_if(materials_, [&](const auto& entry) { return !used(entry.first); });
}

} // namespace lumel
