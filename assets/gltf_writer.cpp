#include "gltf_writer.h"
#include "core/file.h"
#include <algorithm>
#include <cmath>
#include <cstddef>

namespace lumel::assets {
namespace {

using nlohmann::json;

// Numbers of the glTF 2.0 specification (those of WebGL).
constexpr int kFloat = 5126, kUnsignedInt = 5125, kUnsignedByte = 5121, kClampToEdge = 33071, kLinear = 9729,
              kLinearMipLinear = 9987;

json toJson(glm::vec3 v)
{
    return {v.x, v.y, v.z};
}

// The rotation that turns -Z, where glTF's cameras and lights look, in the given direction.
json rotationTo(glm::vec3 towards)
{
    const glm::vec3 forward = glm::normalize(towards);
    const glm::vec3 up = std::abs(forward.y) > 0.999f ? glm::vec3(0, 0, -1) : glm::vec3(0, 1, 0);
    const glm::quat q = glm::quatLookAt(forward, up);
    return {q.x, q.y, q.z, q.w};
}

} // namespace

GltfWriter::GltfWriter(std::filesystem::path folder, std::string name)
    : folder_(std::move(folder)), name_(std::move(name))
{
    std::filesystem::create_directories(folder_);
    json_["asset"] = {{"version", "2.0"}, {"generator", "lumel-assets"}, {"copyright", "CC0 1.0"}};
    json_["extensionsUsed"] = {"KHR_lights_punctual"};
    json_["samplers"] = {{{"magFilter", kLinear},
                          {"minFilter", kLinearMipLinear},
                          {"wrapS", kClampToEdge},
                          {"wrapT", kClampToEdge}}};
    json_["scene"] = 0;
    json_["scenes"] = {{{"name", name_}, {"nodes", json::array()}}};
}

int GltfWriter::addTexture(const std::string& file)
{
    json_["images"].push_back({{"uri", file}});
    json_["textures"].push_back({{"sampler", 0}, {"source", json_["images"].size() - 1}});
    return int(json_["textures"].size()) - 1;
}

int GltfWriter::addColour(const std::string& name, const Image& image)
{
    const std::string file = name_ + "_" + name + ".png";
    writePng(folder_ / file, image, 8);
    return addTexture(file);
}

int GltfWriter::addHeight(const std::string& name, const HeightMap& map)
{
    const std::string height = name_ + "_" + name + "_height.png",
                      normal = name_ + "_" + name + "_normal.png";
    writePng(folder_ / height, map.image, 16);
    writePng(folder_ / normal, normalFromHeight(map), 8);
    const int heightTexture = addTexture(height), normalTexture = addTexture(normal);
    heights_.push_back({heightTexture, normalTexture, map.scale});
    return int(heights_.size()) - 1;
}

int GltfWriter::addMaterial(const std::string& name, const MaterialLook& look)
{
    // alpha = roughness^2 and p = 2 / alpha^2 - 2 (Walter et al. 2007, section 5.2), solved for roughness.
    const float roughness = std::pow(2.0f / (look.power + 2.0f), 0.25f);
    json material = {{"name", name},
                     {"pbrMetallicRoughness",
                      {{"baseColorFactor", {look.baseColour.r, look.baseColour.g, look.baseColour.b, 1.0f}},
                       {"metallicFactor", look.metallic},
                       {"roughnessFactor", roughness}}},
                     {"extras", {{"lumel", {{"power", look.power}}}}}};
    if (look.doubleSided)
        material["doubleSided"] = true;
    if (look.emissive != glm::vec3(0.0f))
        material["emissiveFactor"] = toJson(look.emissive);
    if (look.colourImage >= 0)
        material["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", look.colourImage}};
    if (look.heightImage >= 0) {
        const HeightTextures& maps = heights_[size_t(look.heightImage)];
        material["normalTexture"] = {{"index", maps.normal}};
        material["extras"]["lumel"]["heightTexture"] = {{"index", maps.height}};
        material["extras"]["lumel"]["heightScale"] = maps.scale;
    }
    json_["materials"].push_back(std::move(material));
    return int(json_["materials"].size()) - 1;
}

int GltfWriter::addAccessor(const void* data, size_t bytes, int componentType, size_t count, const char* type)
{
    json_["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", bin_.size()}, {"byteLength", bytes}});
    bin_.append(static_cast<const char*>(data), bytes); // all parts are multiples of 4: stays aligned
    json_["accessors"].push_back({{"bufferView", json_["bufferViews"].size() - 1},
                                  {"componentType", componentType},
                                  {"count", count},
                                  {"type", type}});
    return int(json_["accessors"].size()) - 1;
}

int GltfWriter::addShape(const Shape& shape)
{
    std::vector<glm::vec3> positions, normals;
    std::vector<glm::vec4> tangents;
    std::vector<glm::vec2> uvs;
    Bounds bounds;
    for (const Vertex& v : shape.vertices) {
        positions.push_back(v.position);
        normals.push_back(v.normal);
        tangents.push_back(v.tangent);
        uvs.push_back(v.uv);
        bounds.add(v.position);
    }
    const size_t n = shape.vertices.size();
    json attributes;
    attributes["POSITION"] = addAccessor(positions.data(), n * sizeof positions[0], kFloat, n, "VEC3");
    json_["accessors"].back()["min"] = toJson(bounds.lower);
    json_["accessors"].back()["max"] = toJson(bounds.upper);
    attributes["NORMAL"] = addAccessor(normals.data(), n * sizeof normals[0], kFloat, n, "VEC3");
    attributes["TANGENT"] = addAccessor(tangents.data(), n * sizeof tangents[0], kFloat, n, "VEC4");
    attributes["TEXCOORD_0"] = addAccessor(uvs.data(), n * sizeof uvs[0], kFloat, n, "VEC2");
    const int indices = addAccessor(shape.indices.data(), shape.indices.size() * 4, kUnsignedInt,
                                    shape.indices.size(), "SCALAR");
    if (!shape.colours.empty())
        attributes["COLOR_0"] = addVectors(shape.colours, "VEC3");
    if (!shape.joints.empty()) {
        attributes["JOINTS_0"] =
            addAccessor(shape.joints.data(), n * sizeof shape.joints[0], kUnsignedByte, n, "VEC4");
        attributes["WEIGHTS_0"] = addVectors(shape.weights, "VEC4");
    }
    shapes_.push_back({{"attributes", attributes}, {"indices", indices}});
    for (const Shape& target : shape.targets)
        shapes_.back()["targets"].push_back(addTarget(shape, target));
    return int(shapes_.size()) - 1;
}

json GltfWriter::addTarget(const Shape& from, const Shape& to)
{
    std::vector<glm::vec3> positions, normals, tangents;
    Bounds bounds;
    for (size_t i = 0; i < from.vertices.size(); ++i) {
        const Vertex &a = from.vertices[i], &b = to.vertices[i];
        positions.push_back(b.position - a.position);
        normals.push_back(b.normal - a.normal);
        tangents.push_back(glm::vec3(b.tangent) - glm::vec3(a.tangent));
        bounds.add(positions.back());
    }
    json target = {{"POSITION", addVectors(positions, "VEC3")}};
    json_["accessors"].back()["min"] = toJson(bounds.lower);
    json_["accessors"].back()["max"] = toJson(bounds.upper);
    target["NORMAL"] = addVectors(normals, "VEC3");
    target["TANGENT"] = addVectors(tangents, "VEC3");
    return target;
}

int GltfWriter::addNode(json node, int parent)
{
    json_["nodes"].push_back(std::move(node));
    const int index = int(json_["nodes"].size()) - 1;
    json& siblings = parent < 0 ? json_["scenes"][0]["nodes"] : json_["nodes"][size_t(parent)]["children"];
    siblings.push_back(index);
    return index;
}

void GltfWriter::use(const char* extension)
{
    json& used = json_["extensionsUsed"];
    if (std::find(used.begin(), used.end(), extension) == used.end())
        used.push_back(extension);
}

void GltfWriter::addInstances(const std::string& name, int shape, int material,
                              const std::vector<Instance>& instances)
{
    std::vector<glm::vec3> positions, scales;
    std::vector<glm::vec4> rotations;
    for (const Instance& instance : instances) {
        positions.push_back(instance.position);
        scales.emplace_back(instance.scale);
        rotations.emplace_back(instance.rotation.x, instance.rotation.y, instance.rotation.z,
                               instance.rotation.w);
    }
    use("EXT_mesh_gpu_instancing");
    json node = {{"name", name}, {"mesh", addMesh(name, shape, material)}};
    node["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
        {"TRANSLATION", addVectors(positions, "VEC3")},
        {"ROTATION", addVectors(rotations, "VEC4")},
        {"SCALE", addVectors(scales, "VEC3")}};
    addNode(std::move(node));
}

std::vector<int> GltfWriter::addChain(const std::string& name, int shape, int material, const Placement& foot,
                                      int joints, float spacing)
{
    const float half = glm::radians(0.5f * foot.turnDegrees);
    int parent = addNode({{"name", name + " foot"},
                          {"translation", toJson(foot.position)},
                          {"rotation", {0.0f, std::sin(half), 0.0f, std::cos(half)}},
                          {"scale", toJson(glm::vec3(foot.scale))}});
    std::vector<int> nodes;
    std::vector<glm::mat4> inverses;
    for (int i = 0; i < joints; ++i) {
        json node = {{"name", name + " joint " + std::to_string(i)}};
        if (i > 0)
            node["translation"] = {0.0f, spacing, 0.0f};
        parent = addNode(std::move(node), parent);
        nodes.push_back(parent);
        inverses.push_back(glm::translate(glm::mat4(1.0f), {0.0f, -spacing * float(i), 0.0f}));
    }
    json_["skins"].push_back({{"joints", nodes}, {"inverseBindMatrices", addVectors(inverses, "MAT4")}});
    addNode({{"name", name}, {"mesh", addMesh(name, shape, material)}, {"skin", json_["skins"].size() - 1}});
    return nodes;
}

int GltfWriter::addMesh(const std::string& name, int shape, int material)
{
    const auto [mesh, isNew] = meshes_.try_emplace({shape, material}, meshes_.size());
    if (isNew) {
        json primitive = shapes_[size_t(shape)]; // a shape drawn with several materials shares its vertices
        primitive["material"] = material;
        json_["meshes"].push_back({{"name", name}, {"primitives", {primitive}}});
    }
    return int(mesh->second);
}

int GltfWriter::addObject(const std::string& name, int shape, int material, const Placement& placement)
{
    json node = {{"name", name},
                 {"mesh", addMesh(name, shape, material)},
                 {"translation", toJson(placement.position)}};
    if (placement.turnDegrees != 0.0f) {
        const float half = glm::radians(0.5f * placement.turnDegrees);
        node["rotation"] = {0.0f, std::sin(half), 0.0f, std::cos(half)};
    }
    if (placement.scale != 1.0f)
        node["scale"] = toJson(glm::vec3(placement.scale));
    return addNode(std::move(node));
}

int GltfWriter::addCamera(const std::string& name, glm::vec3 eye, glm::vec3 target, float yFovDegrees,
                          float nearMetres)
{
    json_["cameras"].push_back(
        {{"name", name},
         {"type", "perspective"},
         {"perspective", {{"yfov", glm::radians(yFovDegrees)}, {"znear", nearMetres}}}});
    return addNode({{"name", name},
                    {"camera", json_["cameras"].size() - 1},
                    {"translation", toJson(eye)},
                    {"rotation", rotationTo(target - eye)}});
}

int GltfWriter::addLight(json light, json place)
{
    json& lights = json_["extensions"]["KHR_lights_punctual"]["lights"];
    place["name"] = light["name"];
    lights.push_back(std::move(light));
    place["extensions"] = {{"KHR_lights_punctual", {{"light", lights.size() - 1}}}};
    return addNode(std::move(place));
}

void GltfWriter::addDirectional(const std::string& name, glm::vec3 from, glm::vec3 colour, float lux)
{
    addLight({{"name", name}, {"type", "directional"}, {"color", toJson(colour)}, {"intensity", lux}},
             {{"rotation", rotationTo(-from)}});
}

int GltfWriter::addPoint(const std::string& name, glm::vec3 position, glm::vec3 colour, float candela,
                         float range)
{
    json light = {{"name", name}, {"type", "point"}, {"color", toJson(colour)}, {"intensity", candela}};
    if (range > 0.0f)
        light["range"] = range;
    return addLight(std::move(light), {{"translation", toJson(position)}});
}

void GltfWriter::addSpot(const std::string& name, glm::vec3 position, glm::vec3 target, glm::vec3 colour,
                         float candela, float range, float outerConeDegrees)
{
    const float outer = glm::radians(outerConeDegrees);
    addLight({{"name", name},
              {"type", "spot"},
              {"color", toJson(colour)},
              {"intensity", candela},
              {"range", range},
              {"spot", {{"innerConeAngle", 0.6f * outer}, {"outerConeAngle", outer}}}},
             {{"translation", toJson(position)}, {"rotation", rotationTo(target - position)}});
}

int GltfWriter::addTimes(const std::vector<float>& seconds)
{
    const int accessor = addAccessor(seconds.data(), seconds.size() * 4, kFloat, seconds.size(), "SCALAR");
    json_["accessors"].back()["min"] = {seconds.front()};
    json_["accessors"].back()["max"] = {seconds.back()};
    return accessor;
}

void GltfWriter::addChannels(const std::vector<int>& nodes, const char* path, int input, int output,
                             const char* interpolation)
{
    json& animation = json_["animations"][0];
    animation["samplers"].push_back({{"input", input}, {"output", output}, {"interpolation", interpolation}});
    for (int node : nodes)
        animation["channels"].push_back(
            {{"sampler", animation["samplers"].size() - 1}, {"target", {{"node", node}, {"path", path}}}});
}

void GltfWriter::turn(int node, const std::vector<float>& seconds, const std::vector<glm::quat>& rotations)
{
    std::vector<glm::vec4> values;
    for (const glm::quat& q : rotations)
        values.emplace_back(q.x, q.y, q.z, q.w);
    const int input = addTimes(seconds);
    const int output =
        addAccessor(values.data(), values.size() * sizeof values[0], kFloat, values.size(), "VEC4");
    addChannels({node}, "rotation", input, output, "LINEAR");
}

void GltfWriter::move(const std::vector<int>& nodes, const std::vector<float>& seconds,
                      const std::vector<glm::vec3>& places, const std::vector<glm::vec3>& tangents)
{
    std::vector<glm::vec3> values; // of each key: in-tangent, value, out-tangent
    for (size_t i = 0; i < places.size(); ++i)
        values.insert(values.end(), {tangents[i], places[i], tangents[i]});
    const int input = addTimes(seconds);
    const int output =
        addAccessor(values.data(), values.size() * sizeof values[0], kFloat, values.size(), "VEC3");
    addChannels(nodes, "translation", input, output, "CUBICSPLINE");
}

void GltfWriter::weigh(int node, const std::vector<float>& seconds,
                       const std::vector<std::vector<float>>& weights)
{
    std::vector<float> values; // of each key: in-tangents, values, out-tangents
    for (const std::vector<float>& key : weights) {
        values.insert(values.end(), key.size(), 0.0f);
        values.insert(values.end(), key.begin(), key.end());
        values.insert(values.end(), key.size(), 0.0f);
    }
    const int input = addTimes(seconds), output = addVectors(values, "SCALAR");
    addChannels({node}, "weights", input, output, "CUBICSPLINE");
}

void GltfWriter::write() const
{
    writeFileAtomically(folder_ / (name_ + ".bin"), bin_);
    json document = json_;
    document["buffers"] = {{{"uri", name_ + ".bin"}, {"byteLength", bin_.size()}}};
    // The .gltf is written last: the build takes it as the mark of a complete scene.
    writeFileAtomically(folder_ / (name_ + ".gltf"), document.dump(1) + "\n");
}

} // namespace lumel::assets
