// Collects the meshes that deform while the nodes are read.
#pragma once
#include "reader.h"
#include <optional>
#include <tuple>

namespace lumel::scene {

// Where a node of the scene stands.
struct PlacedNode {
    glm::mat4 world{1.0f};
    int moving = -1; // in Animation::nodes
};

class DeformedMeshReader {
public:
    DeformedMeshReader(Reader& reader, Scene& scene, std::map<int, WeightTrack> tracks)
        : reader_(reader), scene_(scene), tracks_(std::move(tracks))
    {
    }

    // In Scene::deformed for a mesh of the scene under this node, -1 where nothing deforms it.
    int add(const tinygltf::Node& node, int nodeIndex, int mesh);
    // Joints may come after what they deform: call when all nodes have been placed.
    void finish(const std::vector<std::optional<PlacedNode>>& placed);

private:
    int skinOf(int skin);
    void checkJoints(const Mesh& mesh, int skin) const;
    std::vector<float> weightsOf(const tinygltf::Node& node, const Mesh& mesh) const;
    int weightTrackOf(int node);
    std::vector<float> inverseBindMatrices(int skin) const;

    Reader& reader_;
    Scene& scene_;
    std::map<int, WeightTrack> tracks_;              // by glTF node
    std::map<int, int> skins_;                       // by glTF skin, in Scene::skins
    std::map<int, int> trackOf_;                     // by glTF node, in Animation::weights
    std::map<std::tuple<int, int, int>, int> known_; // mesh, skin and whose weights, in Scene::deformed
    size_t joints_ = 0, vertices_ = 0, weights_ = 0;
};

} // namespace lumel::scene
