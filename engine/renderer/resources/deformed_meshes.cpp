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
                               const std::vector<GpuMesh>& meshes)
{
    if (scene.deformed.empty())
        return;
    using MemoryUsage = gpu::Buffer::MemoryUsage;
    const scene::Shapes rest = scene::shapesAtRest(scene);
    size_t matrices = 0, weights = 0;
    firstMatrix_ = firstOfEach(rest.joints, matrices);
    firstWeight_ = firstOfEach(rest.weights, weights);
    // At least one element each: none of them is ever a null address.
    matrices_ =
        gpu::Buffer(device, std::max<size_t>(matrices, 1) * sizeof(glm::mat4), MemoryUsage::host, "joints");
    weights_ =
        gpu::Buffer(device, std::max<size_t>(weights, 1) * sizeof(float), MemoryUsage::host, "weights");
    for (size_t i = 0; i < scene.deformed.size(); ++i)
        items_.push_back(makeItem(device, scene, meshes, i));
    set(rest);
}

DeformedMeshes::Item DeformedMeshes::makeItem(const gpu::Device& device, const scene::Scene& scene,
                                              const std::vector<GpuMesh>& meshes, size_t index) const
{
    const scene::DeformedMesh& deformed = scene.deformed[index];
    const scene::Mesh& mesh = scene.meshes[size_t(deformed.mesh)];
    const GpuMesh& source = meshes[size_t(deformed.mesh)];
    const scene::Deformation& d = mesh.deformation;
    Item item;
    item.vertices =
        gpu::Buffer(device, mesh.vertices.size() * sizeof(shared::Vertex), gpu::Buffer::MemoryUsage::device,
                    mesh.name + " deformed", "use a smaller scene", gpu::MemoryKind::geometry);
    item.skin = deformed.skin;
    item.extents = d.extents;
    const auto addressOr = [&](const gpu::Buffer& buffer) {
        return buffer ? buffer.address() : weights_.address();
    };
    const size_t matrix = deformed.skin >= 0 ? firstMatrix_[size_t(deformed.skin)] : 0;
    item.push = {.rest = source.vertices.address(),
                 .deformed = item.vertices.address(),
                 .joints = addressOr(source.influences),
                 .firstDeltas = addressOr(source.firstDeltas),
                 .deltas = addressOr(source.deltas),
                 .matrices = matrices_.address() + matrix * sizeof(glm::mat4),
                 .weights = weights_.address() + firstWeight_[index] * sizeof(float),
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
        matrices_.write<glm::mat4>(joints_[i], firstMatrix_[i]);
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
        weights_.write<float>(item.weights, firstWeight_[i]);
    }
    return changed;
}

} // namespace lumel
