#include "scene_state.h"
#include "culling.h"
#include "scene/environment.h"

namespace lumel {

SceneState::SceneState(const gpu::Device& device, const scene::Scene& scene, const SceneResources& resources)
    : resources_(resources), frameSet_(device, scene.objects.size()), lights_(frameSet_),
      deformed_(device, scene, *resources.geometry)
{
    lights_.setEnvironment(resources.environment, 0);
    lights_.set(scene::lightsOf(scene), 0);
    for (const scene::Object& object : scene.objects)
        objects_.push_back(makeObject(scene, object, resources, deformed_));
    for (const GpuObject& object : objects_)
        kinds_.insert(kindOf(object));
}

void SceneState::moveObject(size_t object, const glm::mat4& worldFromObject, uint32_t frame)
{
    if (place(objects_[object], worldFromObject, deformed_))
        objects_[object].data.changed = objects_[object].moved = changed_ = frame;
}

void SceneState::deform(const scene::Shapes& shapes, uint32_t frame)
{
    const std::vector<uint8_t> moved = deformed_.set(shapes);
    for (GpuObject& object : objects_)
        if (object.deformed >= 0 && moved[size_t(object.deformed)]) {
            takeShape(object, deformed_);
            object.data.changed = object.moved = changed_ = frame;
        }
}

void SceneState::changeMaterial(size_t material, uint32_t frame)
{
    for (GpuObject& object : objects_)
        if (object.material == &resources_.materials->all()[material]) {
            takeLobes(object);
            kinds_.insert(kindOf(object));
            object.data.changed = changed_ = frame;
        }
}

void SceneState::expectSecondLobes(const std::set<size_t>& materials)
{
    std::set<const GpuMaterial*> expected;
    for (const size_t material : materials)
        expected.insert(&resources_.materials->all()[material]);
    for (const GpuObject& object : objects_)
        if (expected.contains(object.material)) {
            SurfaceKind kind = kindOf(object);
            kind.features |= shared::kFeatureSecondLobe;
            kinds_.insert(kind);
        }
}

bool SceneState::changedSince(size_t object, uint32_t frame) const
{
    if (changed() < frame)
        return false; // nothing has
    if (std::max(objects_[object].data.changed, lights_.changedAll()) >= frame)
        return true;
    const std::span<const shared::Light> lights = lights_.table();
    const LightSet reaching = lightsReaching(objects_[object], lights);
    for (uint32_t i = 0; i < lights.size(); ++i)
        if (lights[i].changed >= frame && contains(reaching, i))
            return true;
    return false;
}

void SceneState::begin(uint32_t place)
{
    frameSet_.begin(place);
    deformed_.begin(place);
}

void SceneState::writeObjects()
{
    const std::span table(objectTable().mapped<shared::Object>(), objects_.size());
    gpu::hostWork().uploadedBytes += table.size_bytes();
    for (size_t i = 0; i < objects_.size(); ++i) {
        shared::Object row = objects_[i].data;
        row.changed = std::max(row.changed, lights_.changedAll());
        table[i] = row; // which is never read here: it may be uncached
    }
}

} // namespace lumel
