// The node tree of the default scene to objects, cameras and lights in world space.
#include "skins.h"
#include <spdlog/spdlog.h>

namespace lumel::scene {
namespace {

bool isFinite(const glm::mat4& m)
{
    for (int c = 0; c < 4; ++c)
        for (int r = 0; r < 4; ++r)
            if (!std::isfinite(m[c][r]))
                return false;
    return true;
}

class NodeReader {
public:
    NodeReader(Reader& reader, Scene& scene) : NodeReader(reader, scene, readTracks(reader)) {}
    NodeReader(Reader& reader, Scene& scene, Tracks tracks)
        : reader_(reader), scene_(scene), placed_(reader.model.nodes.size()),
          tracks_(std::move(tracks.nodes)), deformed_(reader, scene, std::move(tracks.weights))
    {
    }

    // Depth first, in the file's order, with a stack of its own.
    void read()
    {
        std::vector<Visit> stack;
        const std::vector<int> roots = rootNodes();
        for (auto root = roots.rbegin(); root != roots.rend(); ++root)
            stack.push_back({*root, 0, -1, glm::mat4(1.0f)});
        while (!stack.empty()) {
            const Visit visit = stack.back();
            stack.pop_back();
            const tinygltf::Node& node = enter(visit);
            const glm::mat4 world = visit.worldFromParent * localTransform(node, visit.node);
            if (!isFinite(world))
                reader_.fail(fmt::format("node {} has a transform that is not finite", visit.node));
            moving_ = addMoving(node, visit);
            placed_[size_t(visit.node)] = PlacedNode{world, moving_};
            readNode(node, visit.node, world);
            for (auto child = node.children.rbegin(); child != node.children.rend(); ++child)
                stack.push_back({*child, visit.depth + 1, moving_, world});
        }
        deformed_.finish(placed_);
        for (size_t i = 0; i < scene_.objects.size(); ++i)
            addToBounds(i);
    }

private:
    struct Visit {
        int node;
        int depth;
        int movingParent; // in Animation::nodes, -1: stands still
        glm::mat4 worldFromParent;
    };

    std::vector<int> rootNodes() const;
    const tinygltf::Node& enter(const Visit& visit);
    glm::mat4 localTransform(const tinygltf::Node& node, int index) const;
    int addMoving(const tinygltf::Node& node, const Visit& visit);
    void readNode(const tinygltf::Node& node, int index, const glm::mat4& world);
    void addObjects(const tinygltf::Node& node, int index, const glm::mat4& world,
                    const glm::mat4& nodeFromInstance, const std::string& suffix);
    void addToBounds(size_t object);
    void addCamera(const tinygltf::Node& node, const glm::mat4& world);
    void addLight(const tinygltf::Node& node, int index, const glm::mat4& world);
    void readCone(const tinygltf::Light& in, Light& light) const;
    int defaultMaterial();

    Reader& reader_;
    Scene& scene_;
    std::vector<std::optional<PlacedNode>> placed_; // by glTF node; none: not met yet
    std::map<int, NodeTracks> tracks_;              // by glTF node
    DeformedMeshReader deformed_;
    int moving_ = -1; // of the node being read, in Animation::nodes
    PrimitiveCache cache_;
    std::map<int, std::vector<Primitive>> meshes_; // by glTF mesh
    int defaultMaterial_ = -1;
};

// The default scene, else the first one, else every node that is no other's child (glTF 2.0, section 3.5.1,
// leaves it open).
std::vector<int> NodeReader::rootNodes() const
{
    const tinygltf::Model& model = reader_.model;
    const int wanted = model.defaultScene >= 0 ? model.defaultScene : 0;
    if (size_t(wanted) < model.scenes.size())
        return model.scenes[size_t(wanted)].nodes;
    if (model.defaultScene >= 0)
        reader_.fail(fmt::format("the default scene {} does not exist", wanted));
    std::vector<bool> isChild(model.nodes.size(), false);
    for (const tinygltf::Node& node : model.nodes)
        for (int child : node.children)
            if (child >= 0 && size_t(child) < isChild.size())
                isChild[size_t(child)] = true;
    std::vector<int> roots;
    for (size_t i = 0; i < isChild.size(); ++i)
        if (!isChild[i])
            roots.push_back(int(i));
    return roots;
}

const tinygltf::Node& NodeReader::enter(const Visit& visit)
{
    if (visit.node < 0 || size_t(visit.node) >= placed_.size())
        reader_.fail(fmt::format("node {} does not exist", visit.node));
    if (visit.depth > kMaxNodeDepth)
        reader_.fail(fmt::format("nodes are nested deeper than {} levels", kMaxNodeDepth));
    // glTF 2.0, section 3.5.2: strict trees. This is also what ends cycles.
    if (placed_[size_t(visit.node)])
        reader_.fail(fmt::format("node {} has two parents or is its own ancestor", visit.node));
    return reader_.model.nodes[size_t(visit.node)];
}

glm::mat4 NodeReader::localTransform(const tinygltf::Node& node, int index) const
{
    const auto wrong = [&](const char* what) {
        reader_.fail(fmt::format("node {} has a wrong {}", index, what));
    };
    glm::mat4 m(1.0f);
    if (!node.matrix.empty()) {
        if (node.matrix.size() != 16)
            wrong("matrix");
        for (int i = 0; i < 16; ++i)
            m[i / 4][i % 4] = float(node.matrix[size_t(i)]);
        if (m[0][3] != 0.0f || m[1][3] != 0.0f || m[2][3] != 0.0f || m[3][3] != 1.0f)
            wrong("matrix (its last row is not 0 0 0 1)");
        return m;
    }
    const auto &t = node.translation, &r = node.rotation, &s = node.scale;
    if ((!t.empty() && t.size() != 3) || (!s.empty() && s.size() != 3) || (!r.empty() && r.size() != 4))
        wrong("translation, rotation or scale");
    if (!t.empty())
        m = glm::translate(m, glm::vec3(t[0], t[1], t[2]));
    if (!r.empty()) {
        const glm::dquat q(r[3], r[0], r[1], r[2]); // glTF stores x, y, z, w
        if (!(glm::length(q) > 0.0))
            wrong("rotation");
        m *= glm::mat4(glm::mat4_cast(glm::normalize(q)));
    }
    if (!s.empty())
        m = glm::scale(m, glm::vec3(s[0], s[1], s[2]));
    return m;
}

// The node's place in Animation::nodes, -1 when neither it nor an ancestor moves. localTransform() has
// checked what is read here.
int NodeReader::addMoving(const tinygltf::Node& node, const Visit& visit)
{
    const auto tracks = tracks_.find(visit.node);
    if (tracks == tracks_.end() && visit.movingParent < 0)
        return -1;
    MovingNode moving;
    moving.parent = visit.movingParent;
    moving.worldFromParent = visit.worldFromParent;
    moving.matrix = localTransform(node, visit.node);
    if (tracks != tracks_.end()) {
        if (!node.matrix.empty()) // glTF 2.0, section 3.5.3
            reader_.fail(fmt::format("node {} is animated and has a matrix", visit.node));
        const auto &t = node.translation, &r = node.rotation, &s = node.scale;
        moving.moves = true;
        moving.tracks = std::move(tracks->second);
        if (!t.empty())
            moving.translation = glm::vec3(t[0], t[1], t[2]);
        if (!r.empty())
            moving.rotation = glm::quat(glm::normalize(glm::dquat(r[3], r[0], r[1], r[2])));
        if (!s.empty())
            moving.scale = glm::vec3(s[0], s[1], s[2]);
        for (const Track* track : {&moving.tracks.translation, &moving.tracks.rotation, &moving.tracks.scale})
            if (!track->empty())
                scene_.animation.seconds = std::max(scene_.animation.seconds, double(track->seconds.back()));
    }
    scene_.animation.nodes.push_back(std::move(moving));
    return int(scene_.animation.nodes.size()) - 1;
}

void NodeReader::readNode(const tinygltf::Node& node, int index, const glm::mat4& world)
{
    if (node.mesh >= 0) {
        const std::vector<glm::mat4> instances = readInstances(reader_, index);
        for (size_t i = 0; i < instances.size(); ++i)
            addObjects(node, index, world, instances[i], instances.size() > 1 ? fmt::format("#{}", i) : "");
    }
    if (node.camera >= 0)
        addCamera(node, world);
    if (node.extensions.contains("KHR_lights_punctual"))
        addLight(node, index, world);
}

int NodeReader::defaultMaterial()
{
    if (defaultMaterial_ < 0) {
        defaultMaterial_ = int(scene_.materials.size());
        scene_.materials.push_back(Material{});
        scene_.materials.back().name = "default";
    }
    return defaultMaterial_;
}

// suffix: of the name, tells instances apart.
void NodeReader::addObjects(const tinygltf::Node& node, int index, const glm::mat4& worldFromNode,
                            const glm::mat4& nodeFromInstance, const std::string& suffix)
{
    const glm::mat4 world = worldFromNode * nodeFromInstance;
    if (!meshes_.contains(node.mesh))
        meshes_[node.mesh] = readMesh(reader_, node.mesh, scene_, cache_);
    const std::vector<Primitive>& primitives = meshes_[node.mesh];
    const std::string& meshName = reader_.model.meshes[size_t(node.mesh)].name;
    std::string name = printable(node.name.empty() ? meshName : node.name);
    if (name.empty())
        name = fmt::format("node {}", index);
    name += suffix;
    if (!isFinite(world))
        reader_.fail(fmt::format("'{}' has a transform that is not finite", name));
    if (glm::determinant(glm::mat3(world)) == 0.0f) { // how animations hide things
        spdlog::info("{}: '{}' is scaled to nothing; not drawn", reader_.document.file, name);
        return;
    }
    if (scene_.objects.size() + primitives.size() > kMaxObjects)
        reader_.fail(fmt::format("more than {} objects", kMaxObjects), "split the model");
    for (const Primitive& primitive : primitives) {
        Object object;
        object.mesh = primitive.mesh;
        object.material = primitive.material >= 0 ? primitive.material : defaultMaterial();
        object.name = name;
        if (primitives.size() > 1)
            object.name += "/" + scene_.materials[size_t(object.material)].name;
        object.deformed = deformed_.add(node, index, object.mesh);
        // Joints stand in world space: a skin has no use for its node's place (glTF 2.0, section 3.7.3.3).
        const bool skinned = object.deformed >= 0 && scene_.deformed[size_t(object.deformed)].skin >= 0;
        object.worldFromObject = skinned ? nodeFromInstance : world;
        object.node = skinned ? -1 : moving_;
        object.nodeFromObject = nodeFromInstance;
        scene_.objects.push_back(std::move(object));
    }
}

void NodeReader::addToBounds(size_t index)
{
    const Object& object = scene_.objects[index];
    const Bounds box = objectBounds(scene_, index);
    for (int corner = 0; corner < 8; ++corner) {
        const glm::vec3 p(corner & 1 ? box.upper.x : box.lower.x, corner & 2 ? box.upper.y : box.lower.y,
                          corner & 4 ? box.upper.z : box.lower.z);
        scene_.bounds.add(glm::vec3(object.worldFromObject * glm::vec4(p, 1.0f)));
    }
}

void NodeReader::addCamera(const tinygltf::Node& node, const glm::mat4& world)
{
    if (size_t(node.camera) >= reader_.model.cameras.size())
        reader_.fail(fmt::format("camera {} does not exist", node.camera));
    const tinygltf::Camera& in = reader_.model.cameras[size_t(node.camera)];
    Camera camera;
    camera.name = printable(!node.name.empty() ? node.name
                            : !in.name.empty() ? in.name
                                               : fmt::format("camera {}", node.camera));
    if (in.type == "orthographic") {
        spdlog::info("{}: camera '{}' is orthographic; skipped", reader_.document.file, camera.name);
        return;
    }
    camera.yFov = float(in.perspective.yfov);
    camera.nearMetres = float(in.perspective.znear);
    if (!(camera.yFov > 0.0f && camera.yFov < 3.14159f && camera.nearMetres > 0.0f &&
          std::isfinite(camera.nearMetres)))
        reader_.fail(fmt::format("camera '{}' has a field of view or near plane out of range", camera.name));
    // glTF 2.0, section 3.10: looks along the node's -Z, +Y up; scaling does not change the camera.
    if (glm::determinant(glm::mat3(world)) == 0.0f)
        return;
    camera.eye = glm::vec3(world[3]);
    camera.target = camera.eye - glm::normalize(glm::vec3(world[2]));
    camera.up = glm::normalize(glm::vec3(world[1]));
    camera.node = moving_;
    scene_.cameras.push_back(camera);
}

void NodeReader::addLight(const tinygltf::Node& node, int index, const glm::mat4& world)
{
    const tinygltf::Value& extension = node.extensions.at("KHR_lights_punctual");
    if (!extension.Has("light") || !extension.Get("light").IsInt())
        reader_.fail(fmt::format("node {} has KHR_lights_punctual without a light", index));
    const int lightIndex = extension.Get("light").GetNumberAsInt();
    if (lightIndex < 0 || size_t(lightIndex) >= reader_.model.lights.size())
        reader_.fail(fmt::format("light {} does not exist", lightIndex));
    const tinygltf::Light& in = reader_.model.lights[size_t(lightIndex)];
    Light light;
    light.name = printable(!node.name.empty() ? node.name
                           : !in.name.empty() ? in.name
                                              : fmt::format("light {}", lightIndex));
    const auto wrong = [&](const char* what) {
        reader_.fail(fmt::format("light '{}' has a wrong {}", light.name, what));
    };
    if (in.type == "directional")
        light.type = LightType::directional;
    else if (in.type == "point")
        light.type = LightType::point;
    else if (in.type == "spot")
        light.type = LightType::spot;
    else
        wrong("type");
    if (!in.color.empty() && in.color.size() != 3)
        wrong("color");
    for (int c = 0; c < 3 && !in.color.empty(); ++c)
        light.colour[c] = float(in.color[size_t(c)]);
    light.intensity = float(in.intensity);
    light.range = float(in.range);
    for (float value : {light.colour.x, light.colour.y, light.colour.z, light.intensity, light.range})
        if (!(std::isfinite(value) && value >= 0.0f))
            wrong("color, intensity or range");
    if (light.type == LightType::spot)
        readCone(in, light);
    if (glm::length(glm::vec3(world[2])) == 0.0f)
        return; // scaled to nothing: no direction
    light.position = glm::vec3(world[3]);
    light.direction = -glm::normalize(glm::vec3(world[2])); // along the node's -Z
    light.node = moving_;
    scene_.lights.push_back(light);
}

// KHR_lights_punctual: 0 <= inner < outer <= pi/2. Exporters overshoot; that is clamped.
void NodeReader::readCone(const tinygltf::Light& in, Light& light) const
{
    constexpr float kSmallest = 1e-3f; // radians between the two, so that the falloff never divides by 0
    const float inner = float(in.spot.innerConeAngle), outer = float(in.spot.outerConeAngle);
    if (!std::isfinite(inner) || !std::isfinite(outer))
        reader_.fail(fmt::format("light '{}' has a cone out of range", light.name));
    light.outerCone = std::clamp(outer, kSmallest, glm::half_pi<float>());
    light.innerCone = std::clamp(inner, 0.0f, light.outerCone - kSmallest);
}

// Baking what nothing shows would be a waste.
void dropUnusedMaterials(Scene& scene)
{
    std::vector<int> renamed(scene.materials.size(), -1);
    for (const Object& object : scene.objects)
        renamed[size_t(object.material)] = 0;
    std::vector<Material> used;
    for (size_t i = 0; i < renamed.size(); ++i) {
        if (renamed[i] < 0)
            continue;
        renamed[i] = int(used.size());
        used.push_back(std::move(scene.materials[i]));
    }
    scene.materials = std::move(used);
    for (Object& object : scene.objects)
        object.material = renamed[size_t(object.material)];
}

} // namespace

void readNodes(Reader& reader, Scene& scene)
{
    NodeReader(reader, scene).read();
    dropUnusedMaterials(scene);
    if (scene.bounds.empty())
        return;
    // A camera in a file has a direction only. Its target is what orbiting turns about, so it goes to the
    // depth of the scene's middle.
    for (Camera& camera : scene.cameras) {
        const glm::vec3 forward = camera.target - camera.eye;
        const float depth = glm::dot(scene.bounds.centre() - camera.eye, forward);
        camera.target = camera.eye + forward * std::max(depth, 0.1f * scene.bounds.radius() + 1e-3f);
    }
}

} // namespace lumel::scene
