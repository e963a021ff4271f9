#include "nodes.h"
#include <functional>
#include <glm/ext/matrix_transform.hpp>
#include <glm/ext/quaternion_double.hpp>
#include <glm/gtc/quaternion.hpp>
#include <map>

namespace lumel::judge {
namespace {

// By node and path: "translation", "rotation", "scale", "weights".
using Animated = std::map<std::pair<int, std::string>, std::vector<double>>;

Animated animatedAt(const tinygltf::Model& model, double seconds)
{
    Animated animated;
    for (const tinygltf::Animation& animation : model.animations)
        for (const tinygltf::AnimationChannel& channel : animation.channels) {
            const std::string& path = channel.target_path;
            size_t components = path == "rotation" ? 4 : 3;
            if (path == "weights") {
                const int mesh = model.nodes.at(size_t(channel.target_node)).mesh;
                components = model.meshes.at(size_t(mesh)).primitives.at(0).targets.size();
            }
            animated[{channel.target_node, path}] =
                sampleAnimation(model, animation.samplers.at(size_t(channel.sampler)), components,
                                path == "rotation", seconds);
        }
    return animated;
}

glm::dmat4 localTransform(const tinygltf::Node& node, int index, const Animated& animated)
{
    if (!node.matrix.empty()) {
        glm::dmat4 m;
        for (int i = 0; i < 16; ++i)
            m[i / 4][i % 4] = node.matrix[size_t(i)];
        return m;
    }
    const auto property = [&](const char* path, const std::vector<double>& own,
                              std::vector<double> fallback) {
        const auto found = animated.find({index, path});
        return found != animated.end() ? found->second : own.empty() ? fallback : own;
    };
    const auto t = property("translation", node.translation, {0, 0, 0});
    const auto r = property("rotation", node.rotation, {0, 0, 0, 1});
    const auto s = property("scale", node.scale, {1, 1, 1});
    const glm::dmat4 moved = glm::translate(glm::dmat4(1.0), glm::dvec3(t[0], t[1], t[2]));
    const glm::dmat4 turned = glm::mat4_cast(glm::normalize(glm::dquat(r[3], r[0], r[1], r[2])));
    return moved * turned * glm::scale(glm::dmat4(1.0), glm::dvec3(s[0], s[1], s[2]));
}

} // namespace

Pose poseAt(const tinygltf::Model& model, double seconds)
{
    const Animated animated = animatedAt(model, seconds);
    Pose pose;
    pose.worldFromNode.resize(model.nodes.size());
    pose.weights.resize(model.nodes.size());
    pose.inScene.resize(model.nodes.size(), false);
    const std::function<void(int, const glm::dmat4&)> visit = [&](int index, const glm::dmat4& parent) {
        const tinygltf::Node& node = model.nodes.at(size_t(index));
        const glm::dmat4 world = parent * localTransform(node, index, animated);
        pose.worldFromNode[size_t(index)] = world;
        pose.inScene[size_t(index)] = true;
        if (const auto found = animated.find({index, "weights"}); found != animated.end())
            pose.weights[size_t(index)] = found->second;
        else if (!node.weights.empty())
            pose.weights[size_t(index)] = node.weights;
        else if (node.mesh >= 0)
            pose.weights[size_t(index)] = model.meshes.at(size_t(node.mesh)).weights;
        for (const int child : node.children)
            visit(child, world);
    };
    for (const int root : model.scenes.at(size_t(std::max(model.defaultScene, 0))).nodes)
        visit(root, glm::dmat4(1.0));
    return pose;
}

} // namespace lumel::judge
