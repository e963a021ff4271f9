// What deforms a mesh: its vertices' joints and weights, and its morph targets.
#include "reader.h"
#include "scene/vertex_frames.h"
#include <array>

namespace lumel::scene {
namespace {

constexpr size_t kSets = 2; // JOINTS_0 and _1, four joints each

using Attributes = std::map<std::string, int>;

std::vector<float> readAttribute(Reader& reader, const Attributes& attributes, const std::string& name,
                                 int components, Storage storage, size_t count)
{
    const auto found = attributes.find(name);
    if (found == attributes.end())
        return {};
    const size_t elements = accessorCount(reader, found->second);
    if (elements != count)
        reader.fail(fmt::format("{} (accessor {}) has {} elements for {} vertices", name, found->second,
                                elements, count));
    reader.countElements(elements);
    return readFloats(reader, found->second, components, storage, name.c_str());
}

class SkinReader {
public:
    SkinReader(Reader& reader, const Attributes& attributes, const Mesh& mesh, size_t count)
    {
        for (size_t s = 0; s < kSets; ++s) {
            const std::string joints = fmt::format("JOINTS_{}", s), weights = fmt::format("WEIGHTS_{}", s);
            if (attributes.contains(joints) != attributes.contains(weights))
                reader.fail(fmt::format("mesh '{}' has only one of {} and {}", mesh.name, joints, weights));
            joints_[s] = readAttribute(reader, attributes, joints, 4, Storage::unsignedInteger, count);
            weights_[s] = readAttribute(reader, attributes, weights, 4, Storage::floatOrUnorm, count);
        }
    }

    void read(Mesh& mesh) const
    {
        Deformation& d = mesh.deformation;
        std::vector<std::vector<shared::Influence>> all;
        for (const uint32_t source : mesh.sources) {
            all.push_back(influencesOf(source));
            d.jointsPerVertex = std::max(d.jointsPerVertex, uint32_t(all.back().size()));
        }
        std::map<uint32_t, Bounds> boxes;
        for (size_t i = 0; i < all.size(); ++i) {
            for (const shared::Influence& influence : all[i])
                boxes[influence.joint].add(mesh.vertices[i].position);
            all[i].resize(d.jointsPerVertex, {all[i].front().joint, 0.0f});
            d.influences.insert(d.influences.end(), all[i].begin(), all[i].end());
        }
        d.extents.joints.assign(boxes.begin(), boxes.end());
    }

private:
    // Weights are made to sum to 1 (glTF 2.0, section 3.7.3.3, wants them so); negative ones count for
    // nothing. A vertex that no joint influences follows the first.
    std::vector<shared::Influence> influencesOf(uint32_t vertex) const
    {
        std::vector<shared::Influence> found;
        float sum = 0.0f;
        for (size_t s = 0; s < kSets; ++s)
            for (size_t k = 4 * size_t(vertex); !joints_[s].empty() && k < 4 * size_t(vertex) + 4; ++k)
                if (weights_[s][k] > 0.0f) {
                    found.push_back({uint32_t(joints_[s][k]), weights_[s][k]});
                    sum += weights_[s][k];
                }
        if (!std::isfinite(sum) || sum == 0.0f)
            return {{0, 1.0f}};
        for (shared::Influence& influence : found)
            influence.weight /= sum;
        return found;
    }

    std::array<std::vector<float>, kSets> joints_, weights_;
};

class MorphReader {
public:
    MorphReader(Reader& reader, const MadeFrames& made, Mesh& mesh)
        : reader_(reader), made_(made), mesh_(mesh)
    {
    }

    void read(const std::vector<Attributes>& targets, size_t fileVertices)
    {
        reader_.morphElements += targets.size() * mesh_.vertices.size();
        if (reader_.morphElements > kMaxMorphElements)
            reader_.fail(fmt::format("morph targets of more than {} vertices", kMaxMorphElements),
                         "export fewer");
        for (size_t t = 0; t < targets.size(); ++t)
            readTarget(uint32_t(t), targets[t], fileVertices);
        // By vertex; those of one vertex keep the targets' order.
        Deformation& d = mesh_.deformation;
        d.firstDeltas.assign(mesh_.vertices.size() + 1, 0);
        for (const auto& [vertex, delta] : found_)
            ++d.firstDeltas[vertex + 1];
        for (size_t i = 1; i < d.firstDeltas.size(); ++i)
            d.firstDeltas[i] += d.firstDeltas[i - 1];
        std::vector<uint32_t> next(d.firstDeltas.begin(), d.firstDeltas.end() - 1);
        d.deltas.resize(found_.size());
        for (const auto& [vertex, delta] : found_)
            d.deltas[next[vertex]++] = delta;
    }

private:
    void readTarget(uint32_t target, const Attributes& attributes, size_t fileVertices)
    {
        const auto read = [&](const char* name) {
            return readAttribute(reader_, attributes, name, 3, Storage::floatOnly, fileVertices);
        };
        const std::vector<float> positions = read("POSITION");
        const std::vector<float> normals = made_.normals ? std::vector<float>() : read("NORMAL");
        const std::vector<float> tangents = made_.tangents ? std::vector<float>() : read("TANGENT");
        std::vector<shared::MorphDelta> deltas(mesh_.vertices.size(), shared::MorphDelta{target, {}, {}, {}});
        for (size_t i = 0; i < deltas.size(); ++i) {
            const auto of = [&](const std::vector<float>& values) {
                const float* v = values.empty() ? nullptr : &values[3 * size_t(mesh_.sources[i])];
                return v ? glm::vec3(v[0], v[1], v[2]) : glm::vec3(0.0f);
            };
            deltas[i].position = of(positions);
            deltas[i].normal = of(normals);
            deltas[i].tangent = of(tangents);
        }
        if (made_.normals || made_.tangents)
            remakeFrames(deltas);
        keep(deltas);
    }

    // Normals and tangents that the file leaves to us belong to the shape at weight 1 as they do to the mesh
    // (glTF 2.0, section 3.7.2.2).
    void remakeFrames(std::vector<shared::MorphDelta>& deltas) const
    {
        Mesh moved;
        moved.vertices = mesh_.vertices;
        moved.indices = mesh_.indices;
        for (size_t i = 0; i < deltas.size(); ++i) {
            moved.vertices[i].position += deltas[i].position;
            moved.vertices[i].normal += deltas[i].normal;
        }
        if (made_.normals)
            makeFlatNormals(moved); // each triangle has had vertices of its own before
        else
            repairNormals(moved);
        if (made_.tangents)
            makeTangents(moved);
        if (moved.vertices.size() != mesh_.vertices.size())
            return; // a triangle that degenerates may ask for a split that the mesh cannot have
        for (size_t i = 0; i < deltas.size(); ++i) {
            if (made_.normals)
                deltas[i].normal = moved.vertices[i].normal - mesh_.vertices[i].normal;
            if (made_.tangents)
                deltas[i].tangent =
                    glm::vec3(moved.vertices[i].tangent) - glm::vec3(mesh_.vertices[i].tangent);
        }
    }

    void keep(const std::vector<shared::MorphDelta>& deltas)
    {
        Bounds box;
        const size_t before = found_.size();
        for (size_t i = 0; i < deltas.size(); ++i) {
            const shared::MorphDelta& d = deltas[i];
            if (d.position == glm::vec3(0.0f) && d.normal == glm::vec3(0.0f) && d.tangent == glm::vec3(0.0f))
                continue;
            box.add(d.position);
            found_.emplace_back(uint32_t(i), d);
        }
        if (found_.size() - before < deltas.size())
            box.add(glm::vec3(0.0f)); // what it leaves alone
        mesh_.deformation.extents.targets.push_back(box);
    }

    Reader& reader_;
    MadeFrames made_;
    Mesh& mesh_;
    std::vector<std::pair<uint32_t, shared::MorphDelta>> found_; // vertex, what moves it
};

} // namespace

bool deforms(const tinygltf::Primitive& primitive)
{
    return primitive.attributes.contains("JOINTS_0") || primitive.attributes.contains("WEIGHTS_0") ||
           !primitive.targets.empty();
}

void readDeformation(Reader& reader, const tinygltf::Primitive& primitive, const MadeFrames& made, Mesh& mesh)
{
    mesh.deformation.extents.mesh = mesh.bounds;
    const size_t fileVertices = accessorCount(reader, primitive.attributes.at("POSITION"));
    if (primitive.attributes.contains("JOINTS_0") || primitive.attributes.contains("WEIGHTS_0"))
        SkinReader(reader, primitive.attributes, mesh, fileVertices).read(mesh);
    if (!primitive.targets.empty())
        MorphReader(reader, made, mesh).read(primitive.targets, fileVertices);
}

} // namespace lumel::scene
