// Which meshes deform, and by what: skins of joints, and weights of morph targets.
#include "skins.h"

namespace lumel::scene {

int DeformedMeshReader::add(const tinygltf::Node& node, int nodeIndex, int mesh)
{
    const Mesh& source = scene_.meshes[size_t(mesh)];
    const bool skinned = node.skin >= 0 && !source.deformation.influences.empty();
    const bool morphed = !source.deformation.extents.targets.empty();
    if (!skinned && !morphed)
        return -1;
    const std::vector<double>& weights = node.weights;
    const auto track = tracks_.find(nodeIndex);
    // Nodes without weights of their own share the mesh's.
    const bool ownWeights = morphed && (!weights.empty() || track != tracks_.end());
    const int skin = skinned ? skinOf(node.skin) : -1;
    const auto [entry, isNew] =
        known_.try_emplace({mesh, skin, ownWeights ? nodeIndex : -1}, int(scene_.deformed.size()));
    if (!isNew)
        return entry->second;
    DeformedMesh deformed;
    deformed.mesh = mesh;
    deformed.skin = skin;
    if (skinned)
        checkJoints(source, node.skin);
    if (morphed)
        deformed.weights = weightsOf(node, source);
    if (ownWeights && track != tracks_.end())
        deformed.weightTrack = weightTrackOf(nodeIndex);
    vertices_ += source.vertices.size();
    weights_ += deformed.weights.size();
    if (vertices_ > kMaxDeformedVertices || weights_ > kMaxMorphWeights)
        reader_.fail(
            fmt::format("skins and morph targets deform more than {} vertices by more than {} weights",
                        kMaxDeformedVertices, kMaxMorphWeights),
            "split the model");
    scene_.deformed.push_back(std::move(deformed));
    return entry->second;
}

// In Scene::skins; its joints are filled in by finish().
int DeformedMeshReader::skinOf(int skin)
{
    if (size_t(skin) >= reader_.model.skins.size())
        reader_.fail(fmt::format("skin {} does not exist", skin));
    const auto [entry, isNew] = skins_.try_emplace(skin, int(scene_.skins.size()));
    if (isNew) {
        joints_ += reader_.model.skins[size_t(skin)].joints.size();
        if (joints_ > kMaxJoints)
            reader_.fail(fmt::format("more than {} joints", kMaxJoints), "split the model");
        scene_.skins.emplace_back();
    }
    return entry->second;
}

void DeformedMeshReader::checkJoints(const Mesh& mesh, int skin) const
{
    const size_t count = reader_.model.skins[size_t(skin)].joints.size();
    const uint32_t last = mesh.deformation.extents.joints.back().first;
    if (last >= count)
        reader_.fail(
            fmt::format("mesh '{}' names joint {} of skin {}, which has {}", mesh.name, last, skin, count));
}

std::vector<float> DeformedMeshReader::weightsOf(const tinygltf::Node& node, const Mesh& mesh) const
{
    const std::vector<double>& given =
        node.weights.empty() ? reader_.model.meshes[size_t(node.mesh)].weights : node.weights;
    std::vector<float> weights(mesh.deformation.extents.targets.size(), 0.0f);
    if (!given.empty() && given.size() != weights.size())
        reader_.fail(fmt::format("mesh '{}' has {} weights for {} morph targets", mesh.name, given.size(),
                                 weights.size()));
    for (size_t i = 0; i < given.size(); ++i) {
        weights[i] = float(given[i]);
        if (!std::isfinite(weights[i]))
            reader_.fail(fmt::format("mesh '{}' has a weight that is not finite", mesh.name));
    }
    return weights;
}

int DeformedMeshReader::weightTrackOf(int node)
{
    const auto [entry, isNew] = trackOf_.try_emplace(node, int(scene_.animation.weights.size()));
    if (isNew) {
        WeightTrack& track = tracks_.at(node);
        scene_.animation.seconds = std::max(scene_.animation.seconds, double(track.seconds.back()));
        scene_.animation.weights.push_back(std::move(track));
    }
    return entry->second;
}

void DeformedMeshReader::finish(const std::vector<std::optional<PlacedNode>>& placed)
{
    for (const auto& [index, slot] : skins_) {
        const tinygltf::Skin& in = reader_.model.skins[size_t(index)];
        const std::vector<float> inverses = inverseBindMatrices(index);
        for (size_t j = 0; j < in.joints.size(); ++j) {
            const int node = in.joints[j];
            if (node < 0 || size_t(node) >= placed.size() || !placed[size_t(node)])
                reader_.fail(
                    fmt::format("skin {} names joint node {}, which is not in the scene", index, node));
            Joint joint{.node = placed[size_t(node)]->moving,
                        .worldFromJoint = placed[size_t(node)]->world,
                        .jointFromMesh = glm::mat4(1.0f)};
            for (int k = 0; k < 16 && !inverses.empty(); ++k)
                joint.jointFromMesh[k / 4][k % 4] = inverses[16 * j + size_t(k)];
            scene_.skins[size_t(slot)].joints.push_back(joint);
        }
    }
    const Shapes shapes = shapesAtRest(scene_);
    for (size_t i = 0; i < scene_.deformed.size(); ++i) {
        DeformedMesh& deformed = scene_.deformed[i];
        const Mesh& mesh = scene_.meshes[size_t(deformed.mesh)];
        deformed.bounds = deformedBounds(
            mesh.deformation.extents, deformed.skin >= 0 ? shapes.joints[size_t(deformed.skin)] : Matrices(),
            deformed.weights);
        const glm::vec3 size = deformed.bounds.upper - deformed.bounds.lower;
        if (!std::isfinite(size.x + size.y + size.z))
            reader_.fail(fmt::format("mesh '{}' has skinned vertices that are not finite", mesh.name));
    }
}

// Empty: identities (glTF 2.0, section 3.7.3.1).
std::vector<float> DeformedMeshReader::inverseBindMatrices(int skin) const
{
    const tinygltf::Skin& in = reader_.model.skins[size_t(skin)];
    if (in.inverseBindMatrices < 0)
        return {};
    const size_t count = accessorCount(reader_, in.inverseBindMatrices);
    if (count < in.joints.size() || count > kMaxJoints)
        reader_.fail(
            fmt::format("skin {} has {} inverse bind matrices for {} joints", skin, count, in.joints.size()));
    return readFloats(reader_, in.inverseBindMatrices, 16, Storage::floatOnly, "inverse bind matrices");
}

} // namespace lumel::scene
