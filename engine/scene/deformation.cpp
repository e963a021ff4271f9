#include "deformation.h"
#include "scene.h"
#include "shared/deform.h"

namespace lumel::scene {
namespace {

void addBox(Bounds& bounds, const Bounds& box, const glm::mat4& m)
{
    for (int corner = 0; corner < 8; ++corner)
        bounds.add(glm::vec3(m * glm::vec4(corner & 1 ? box.upper.x : box.lower.x,
                                           corner & 2 ? box.upper.y : box.lower.y,
                                           corner & 4 ? box.upper.z : box.lower.z, 1.0f)));
}

} // namespace

Deformation gathered(const Deformation& from, std::span<const uint32_t> sources)
{
    Deformation to;
    to.jointsPerVertex = from.jointsPerVertex;
    to.extents = from.extents;
    if (!from.firstDeltas.empty())
        to.firstDeltas.push_back(0);
    for (const uint32_t source : sources) {
        const auto joints = from.influences.begin() + ptrdiff_t(source) * from.jointsPerVertex;
        to.influences.insert(to.influences.end(), joints, joints + from.jointsPerVertex);
        if (from.firstDeltas.empty())
            continue;
        to.deltas.insert(to.deltas.end(), from.deltas.begin() + from.firstDeltas[source],
                         from.deltas.begin() + from.firstDeltas[source + 1]);
        to.firstDeltas.push_back(uint32_t(to.deltas.size()));
    }
    return to;
}

Matrices jointMatrices(const Skin& skin, const Matrices& pose)
{
    Matrices matrices;
    matrices.reserve(skin.joints.size());
    for (const Joint& joint : skin.joints) {
        const bool moved = joint.node >= 0 && !pose.empty();
        matrices.push_back((moved ? pose[size_t(joint.node)] : joint.worldFromJoint) * joint.jointFromMesh);
    }
    return matrices;
}

Shapes shapesAtRest(const Scene& scene)
{
    Shapes shapes;
    for (const Skin& skin : scene.skins)
        shapes.joints.push_back(jointMatrices(skin));
    for (const DeformedMesh& mesh : scene.deformed)
        shapes.weights.push_back(mesh.weights);
    return shapes;
}

Shapes shapesAt(const std::vector<Skin>& skins, const std::vector<DeformedMesh>& deformed,
                const Animation& animation, double seconds)
{
    Shapes shapes;
    const Matrices pose = poseAt(animation, seconds);
    for (const Skin& skin : skins)
        shapes.joints.push_back(jointMatrices(skin, pose));
    for (const DeformedMesh& mesh : deformed)
        shapes.weights.push_back(mesh.weightTrack < 0
                                     ? mesh.weights
                                     : sampleWeights(animation.weights[size_t(mesh.weightTrack)],
                                                     timeInRound(animation, seconds)));
    return shapes;
}

Bounds deformedBounds(const Extents& extents, std::span<const glm::mat4> matrices,
                      std::span<const float> weights)
{
    glm::vec3 lower(0.0f), upper(0.0f); // what the morph targets add at most
    for (size_t i = 0; i < extents.targets.size(); ++i) {
        const glm::vec3 a = weights[i] * extents.targets[i].lower, b = weights[i] * extents.targets[i].upper;
        lower += glm::min(a, b);
        upper += glm::max(a, b);
    }
    Bounds bounds;
    const auto add = [&](const Bounds& box, const glm::mat4& m) {
        addBox(bounds, {box.lower + lower, box.upper + upper}, m);
    };
    if (matrices.empty())
        add(extents.mesh, glm::mat4(1.0f));
    else
        for (const auto& [joint, box] : extents.joints)
            add(box, matrices[joint]);
    return bounds;
}

std::vector<shared::Vertex> deformedVertices(const Mesh& mesh, std::span<const glm::mat4> matrices,
                                             std::span<const float> weights)
{
    const Deformation& d = mesh.deformation;
    std::vector<shared::Vertex> vertices = mesh.vertices;
    for (size_t i = 0; i < vertices.size(); ++i) {
        if (!d.firstDeltas.empty())
            for (uint32_t k = d.firstDeltas[i]; k < d.firstDeltas[i + 1]; ++k)
                vertices[i] = shared::morphed(vertices[i], d.deltas[k], weights[d.deltas[k].target]);
        glm::mat4 m(matrices.empty() ? 1.0f : 0.0f);
        for (size_t k = i * d.jointsPerVertex; !matrices.empty() && k < (i + 1) * d.jointsPerVertex; ++k)
            m += d.influences[k].weight * matrices[d.influences[k].joint];
        vertices[i] = shared::skinned(vertices[i], m);
    }
    return vertices;
}

std::vector<shared::Vertex> deformedVertices(const Scene& scene, int deformed)
{
    if (deformed < 0)
        return {};
    const DeformedMesh& d = scene.deformed[size_t(deformed)];
    return deformedVertices(scene.meshes[size_t(d.mesh)],
                            d.skin >= 0 ? jointMatrices(scene.skins[size_t(d.skin)]) : Matrices(), d.weights);
}

Bounds objectBounds(const Scene& scene, size_t object)
{
    const Object& o = scene.objects[object];
    return o.deformed < 0 ? scene.meshes[size_t(o.mesh)].bounds : scene.deformed[size_t(o.deformed)].bounds;
}

} // namespace lumel::scene
