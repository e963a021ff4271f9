#include "deformed_meshes.h"

namespace lumel {
namespace {

template<class Lists>
std::vector<size_t> firstOfEach(const Lists& lists, size_t& total)
{
    std::vector<size_t> first;
    for (const auto& list : lists) {
        first.push_back(total);
        total += list.size();
    }
    return first;
}

} // namespace

DeformedMeshes::DeformedMeshes(const gpu::Device& device, const scene::Scene& scene,
                               const GeometryResources& geometry)
{
    if (scene.deformed.empty())
        return;
    device_ = &device;
    const scene::Shapes rest = scene::shapesAtRest(scene);
    firstMatrix_ = firstOfEach(rest.joints, matrixCount_);
    firstWeight_ = firstOfEach(rest.weights, weightCount_);
    begin(0);
    for (size_t i = 0; i < scene.deformed.size(); ++i)
        items_.push_back(makeItem(device, scene, geometry, i));
    set(rest);
}

void DeformedMeshes::begin(uint32_t place)
{
    place_ = place;
    Place& p = places_[place];
    if (p.matrices || !device_)
        return;
    // At least one element each: none of them is ever a null address.
    constexpr auto kUsage = gpu::Buffer::MemoryUsage::host;
    p.matrices =
        gpu::Buffer(*device_, std::max<size_t>(matrixCount_, 1) * sizeof(glm::mat4), kUsage, "joints");
    p.weights = gpu::Buffer(*device_, std::max<size_t>(weightCount_, 1) * sizeof(float), kUsage, "weights");
}

DeformedMeshes::Item DeformedMeshes::makeItem(const gpu::Device& device, const scene::Scene& scene,
                                              const GeometryResources& geometry, size_t index) const
{
    const scene::DeformedMesh& deformed = scene.deformed[index];
    const scene::Mesh& mesh = scene.meshes[size_t(deformed.mesh)];
    const GpuMesh& source = geometry.meshes()[size_t(deformed.mesh)];
    const scene::Deformation& d = mesh.deformation;
    Item item;
    item.vertices =
        gpu::Buffer(device, mesh.vertices.size() * sizeof(shared::Vertex), gpu::Buffer::MemoryUsage::device,
                    mesh.name + " deformed", "use a smaller scene", gpu::MemoryKind::geometry);
    item.texels.emplace(device, geometry.vertexTexelLayout(), item.vertices);
    item.skin = deformed.skin;
    item.extents = d.extents;
    const auto addressOr = [&](const gpu::Buffer& buffer) {
        return buffer ? buffer.address() : source.vertices.address; // never read
    };
    item.push = {.rest = source.vertices.address,
                 .deformed = item.vertices.address(),
                 .joints = addressOr(source.influences),
                 .firstDeltas = addressOr(source.firstDeltas),
                 .deltas = addressOr(source.deltas),
                 .matrices = 0,
                 .weights = 0,
                 .vertexCount = uint32_t(mesh.vertices.size()),
                 .influences = deformed.skin >= 0 ? d.jointsPerVertex : 0u,
                 .morphs = d.deltas.empty() ? 0u : 1u};
    return item;
}

std::vector<uint8_t> DeformedMeshes::set(const scene::Shapes& shapes)
{
    joints_.resize(firstMatrix_.size());
    std::vector<uint8_t> deformed(joints_.size(), 0);
    for (size_t i = 0; i < joints_.size(); ++i) {
        if (joints_[i] == shapes.joints[i])
            continue; // animations pause
        deformed[i] = 1;
        joints_[i] = shapes.joints[i];
    }
    static const scene::Matrices kNone;
    std::vector<uint8_t> changed(items_.size(), 0);
    for (size_t i = 0; i < items_.size(); ++i) {
        Item& item = items_[i];
        const bool isDeformed = item.skin >= 0 && deformed[size_t(item.skin)];
        if (!isDeformed && item.weights == shapes.weights[i] && !item.bounds.empty())
            continue;
        const scene::Matrices& joints = item.skin >= 0 ? joints_[size_t(item.skin)] : kNone;
        changed[i] = 1;
        item.stale = true;
        item.weights = shapes.weights[i];
        item.bounds = scene::deformedBounds(item.extents, joints, item.weights);
        item.mirrored =
            !joints.empty() && glm::determinant(glm::mat3(joints[item.extents.joints.front().first])) < 0.0f;
    }
    return changed;
}

shared::DeformPush DeformedMeshes::write(size_t index)
{
    Item& item = items_[index];
    const Place& place = places_[place_];
    const size_t matrix = item.skin >= 0 ? firstMatrix_[size_t(item.skin)] : 0;
    if (item.skin >= 0)
        place.matrices.write<glm::mat4>(joints_[size_t(item.skin)], matrix);
    place.weights.write<float>(item.weights, firstWeight_[index]);
    item.stale = false;
    shared::DeformPush push = item.push;
    push.matrices = place.matrices.address() + matrix * sizeof(glm::mat4);
    push.weights = place.weights.address() + firstWeight_[index] * sizeof(float);
    return push;
}

} // namespace lumel
