#include "model.h"
#include "nodes.h"
#include <stdexcept>
#include <utility>

namespace lumel::judge {
namespace {

tinygltf::Model load(const std::filesystem::path& file)
{
    tinygltf::TinyGLTF reader;
    tinygltf::Model model;
    std::string error, warning;
    if (!reader.LoadASCIIFromFile(&model, &error, &warning, file.string()) || !error.empty())
        throw std::runtime_error("tinygltf: " + error);
    return model;
}

using Attributes = std::map<std::string, int>;

Values attribute(const tinygltf::Model& model, const Attributes& attributes, const char* name)
{
    const auto found = attributes.find(name);
    return readAccessor(model, found == attributes.end() ? -1 : found->second);
}

// A primitive's vertices as the file has them.
struct Vertices {
    Values positions, normals, tangents, uvs[2], colours;
    Values joints[2], weights[2];
    struct Target {
        Values positions, normals, tangents;
    };
    std::vector<Target> targets;

    Vertices(const tinygltf::Model& model, const tinygltf::Primitive& primitive)
        : positions(attribute(model, primitive.attributes, "POSITION")),
          normals(attribute(model, primitive.attributes, "NORMAL")),
          tangents(attribute(model, primitive.attributes, "TANGENT")),
          uvs{attribute(model, primitive.attributes, "TEXCOORD_0"),
              attribute(model, primitive.attributes, "TEXCOORD_1")},
          colours(attribute(model, primitive.attributes, "COLOR_0")),
          joints{attribute(model, primitive.attributes, "JOINTS_0"),
                 attribute(model, primitive.attributes, "JOINTS_1")},
          weights{attribute(model, primitive.attributes, "WEIGHTS_0"),
                  attribute(model, primitive.attributes, "WEIGHTS_1")}
    {
        for (const Attributes& target : primitive.targets)
            targets.push_back({attribute(model, target, "POSITION"), attribute(model, target, "NORMAL"),
                               attribute(model, target, "TANGENT")});
    }
};

// A vertex before anything but morph targets has moved it. Bitangent: glTF 2.0, section 3.7.2.1.
Corner restCorner(const Vertices& v, size_t i, const std::vector<double>& weights)
{
    Corner corner{};
    corner.position = v.positions.vec3(i);
    if (v.normals.numbers.empty())
        throw std::runtime_error("the judge wants normals");
    corner.normal = v.normals.vec3(i);
    if (!v.tangents.numbers.empty())
        corner.tangent = v.tangents.vec3(i);
    for (size_t t = 0; t < v.targets.size() && t < weights.size(); ++t) {
        const auto& target = v.targets[t];
        const auto add = [&](const Values& values, glm::dvec3& to) {
            if (!values.numbers.empty())
                to += weights[t] * values.vec3(i);
        };
        add(target.positions, corner.position);
        add(target.normals, corner.normal);
        add(target.tangents, corner.tangent);
    }
    corner.normal = glm::normalize(corner.normal);
    if (!v.tangents.numbers.empty())
        corner.bitangent = glm::cross(corner.normal, glm::normalize(corner.tangent)) * v.tangents.at(i)[3];
    for (int set = 0; set < 2; ++set)
        if (!v.uvs[set].numbers.empty())
            corner.uv[set] = v.uvs[set].vec2(i);
    corner.colour = glm::dvec4(1.0);
    for (size_t c = 0; c < v.colours.components && !v.colours.numbers.empty(); ++c)
        corner.colour[int(c)] = v.colours.at(i)[c];
    return corner;
}

// glTF 2.0, section 3.7.3: the weighted sum of the joints' matrices; the skinned node's own counts for
// nothing.
glm::dmat4 skinMatrix(const Pose& pose, const tinygltf::Skin& skin, const Values& inverseBind,
                      const Vertices& v, size_t i)
{
    glm::dmat4 sum(0.0);
    for (int set = 0; set < 2; ++set)
        for (size_t k = 0; k < 4 && !v.joints[set].numbers.empty(); ++k) {
            const auto joint = size_t(v.joints[set].at(i)[k]);
            const glm::dmat4 inverse =
                inverseBind.numbers.empty() ? glm::dmat4(1.0) : inverseBind.mat4(joint);
            sum += v.weights[set].at(i)[k] * pose.worldFromNode.at(size_t(skin.joints.at(joint))) * inverse;
        }
    return sum;
}

void move(Corner& corner, const glm::dmat4& m)
{
    corner.position = glm::dvec3(m * glm::dvec4(corner.position, 1.0));
    corner.normal = glm::normalize(glm::transpose(glm::inverse(glm::dmat3(m))) * corner.normal);
    // Directions on the surface go with it: where the matrix mirrors, so does the tangent frame.
    corner.tangent = glm::dmat3(m) * corner.tangent;
    corner.bitangent = glm::dmat3(m) * corner.bitangent;
}

// Along u and against v on the triangle: green points to the image's upper edge.
void giveTangents(Triangle& triangle, const Texture& texture)
{
    const Corner* c = triangle.corners;
    const glm::dvec3 d1 = c[1].position - c[0].position, d2 = c[2].position - c[0].position;
    const glm::dvec2 at = texture.place(c[0].uv);
    const glm::dvec2 e1 = texture.place(c[1].uv) - at, e2 = texture.place(c[2].uv) - at;
    const double area = e1.x * e2.y - e2.x * e1.y;
    for (Corner& corner : triangle.corners) {
        corner.tangent = area == 0.0 ? glm::dvec3(1, 0, 0) : (e2.y * d1 - e1.y * d2) / area;
        corner.bitangent = area == 0.0 ? glm::dvec3(0, 1, 0) : -(e1.x * d2 - e2.x * d1) / area;
    }
}

class ModelReader {
public:
    ModelReader(const tinygltf::Model& in, double seconds) : in_(in), pose_(poseAt(in, seconds))
    {
        for (int i = 0; i < int(in.materials.size()); ++i)
            out_.materials.push_back(readMaterial(in, i));
        out_.materials.push_back(readMaterial(in, -1));
    }
    Model read()
    {
        bool camera = false;
        for (size_t i = 0; i < in_.nodes.size(); ++i) {
            const tinygltf::Node& node = in_.nodes[i];
            if (!pose_.inScene[i])
                continue;
            if (node.mesh >= 0)
                for (const auto& primitive : in_.meshes.at(size_t(node.mesh)).primitives)
                    addPrimitive(node, i, primitive);
            if (node.camera >= 0 && !std::exchange(camera, true))
                out_.camera = {pose_.worldFromNode[i], in_.cameras.at(size_t(node.camera)).perspective.yfov};
            if (const auto light = node.extensions.find("KHR_lights_punctual");
                light != node.extensions.end())
                addLight(pose_.worldFromNode[i], light->second.Get("light").GetNumberAsInt());
        }
        return std::move(out_);
    }

private:
    void addPrimitive(const tinygltf::Node& node, size_t index, const tinygltf::Primitive& primitive)
    {
        if (primitive.mode != TINYGLTF_MODE_TRIANGLES || primitive.indices < 0)
            throw std::runtime_error("the judge wants indexed triangles");
        const Vertices vertices(in_, primitive);
        const Values indices = readAccessor(in_, primitive.indices);
        const bool skinned = node.skin >= 0;
        const tinygltf::Skin* skin = skinned ? &in_.skins.at(size_t(node.skin)) : nullptr;
        const Values inverseBind = readAccessor(in_, skinned ? skin->inverseBindMatrices : -1);
        const int material = primitive.material >= 0 ? primitive.material : int(out_.materials.size()) - 1;
        for (size_t i = 0; i + 2 < indices.numbers.size(); i += 3) {
            Triangle triangle{};
            triangle.material = material;
            bool mirrored = false;
            for (size_t c = 0; c < 3; ++c) {
                const auto v = size_t(indices.numbers[i + c]);
                triangle.corners[c] = restCorner(vertices, v, pose_.weights[index]);
                const glm::dmat4 world =
                    skinned ? skinMatrix(pose_, *skin, inverseBind, vertices, v) : pose_.worldFromNode[index];
                move(triangle.corners[c], world);
                mirrored = glm::determinant(glm::dmat3(world)) < 0.0;
            }
            const Corner* c = triangle.corners;
            triangle.front = glm::cross(c[1].position - c[0].position, c[2].position - c[0].position);
            if (mirrored) // glTF 2.0, section 3.7.4: a negative determinant turns the winding round
                triangle.front = -triangle.front;
            if (vertices.tangents.numbers.empty())
                giveTangents(triangle, out_.materials[size_t(material)].tangentTexture());
            out_.triangles.push_back(triangle);
        }
    }

    void addLight(const glm::dmat4& world, int index)
    {
        const tinygltf::Light& in = in_.lights.at(size_t(index));
        Light light;
        light.type = in.type;
        light.position = glm::dvec3(world[3]);
        light.direction = -glm::normalize(glm::dvec3(world[2])); // along the node's -Z
        light.intensity = glm::dvec3(in.intensity);
        for (int c = 0; c < int(in.color.size()); ++c)
            light.intensity[c] *= in.color[size_t(c)];
        light.range = in.range;
        light.innerCone = in.spot.innerConeAngle;
        light.outerCone = in.spot.outerConeAngle;
        out_.lights.push_back(light);
    }

    const tinygltf::Model& in_;
    Pose pose_;
    Model out_;
};

} // namespace

Model readModel(const std::filesystem::path& file, double seconds)
{
    const tinygltf::Model model = load(file);
    return ModelReader(model, seconds).read();
}

} // namespace lumel::judge
