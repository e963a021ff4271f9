#include "visibility.h"
#include <algorithm>
#include <cmath>

namespace lumel::scene {
namespace {

constexpr float kLeastArea =
    4.0f / (960.0f * 540.0f);  // of the picture's 4 in clip space, after division by w
constexpr int kWayPoints = 16; // of an animation

// Distances to the planes of the view: left, right, bottom, top, near (reversed depth: z <= w).
std::array<float, 5> distances(glm::vec4 clip)
{
    return {clip.w + clip.x, clip.w - clip.x, clip.w + clip.y, clip.w - clip.y, clip.w - clip.z};
}

// Sutherland and Hodgman 1974, "Reentrant Polygon Clipping", by one plane after the other.
std::vector<glm::vec4> clipped(std::vector<glm::vec4> polygon)
{
    for (size_t plane = 0; plane < 5; ++plane) {
        std::vector<glm::vec4> inside;
        for (size_t i = 0; i < polygon.size(); ++i) {
            const glm::vec4 a = polygon[i], b = polygon[(i + 1) % polygon.size()];
            const float da = distances(a)[plane], db = distances(b)[plane];
            if (da >= 0.0f)
                inside.push_back(a);
            if ((da >= 0.0f) != (db >= 0.0f))
                inside.push_back(glm::mix(a, b, da / (da - db)));
        }
        polygon = std::move(inside);
    }
    return polygon;
}

// In the picture, whose width and height are 2.
float areaSeen(glm::vec4 a, glm::vec4 b, glm::vec4 c)
{
    for (size_t plane = 0; plane < 5; ++plane)
        if (distances(a)[plane] < 0.0f && distances(b)[plane] < 0.0f && distances(c)[plane] < 0.0f)
            return 0.0f;
    float area = 0.0f; // twice
    const std::vector<glm::vec4> polygon = clipped({a, b, c});
    for (size_t i = 0; i < polygon.size(); ++i) {
        const glm::vec4 p = polygon[i], q = polygon[(i + 1) % polygon.size()];
        if (p.w <= 0.0f || q.w <= 0.0f)
            return 0.0f;
        area += (p.x * q.y - p.y * q.x) / (p.w * q.w);
    }
    return 0.5f * std::abs(area);
}

bool isTransparent(const Material& material)
{
    if (material.alphaMode == AlphaMode::mask)
        return material.baseColor.a < material.alphaCutoff;
    return material.alphaMode == AlphaMode::blend && material.baseColor.a <= 0.0f;
}

bool isOutside(const Bounds& box, const glm::mat4& clipFromObject)
{
    std::array<int, 5> outside{};
    for (int corner = 0; corner < 8; ++corner) {
        const auto d = distances(clipFromObject * glm::vec4(box.corner(corner), 1.0f));
        for (size_t plane = 0; plane < 5; ++plane)
            outside[plane] += d[plane] < 0.0f;
    }
    return std::ranges::any_of(outside, [](int corners) { return corners == 8; });
}

// Adds what is seen of the object to `area`, until it is enough.
void addArea(const Scene& scene, size_t index, const Pose& pose, const glm::mat4& clipFromWorld,
             glm::vec3 eye, float& area)
{
    const Object& object = scene.objects[index];
    const Material& material = scene.materials[size_t(object.material)];
    const glm::mat4 worldFromObject = pose.empty() || object.node < 0
                                          ? object.worldFromObject
                                          : pose[size_t(object.node)] * object.nodeFromObject;
    const glm::mat4 clipFromObject = clipFromWorld * worldFromObject;
    if (isTransparent(material) || isOutside(objectBounds(scene, index), clipFromObject))
        return;
    const Mesh& mesh = scene.meshes[size_t(object.mesh)];
    const std::vector<Vertex> deformed = deformedVertices(scene, object.deformed);
    const std::vector<Vertex>& vertices = deformed.empty() ? mesh.vertices : deformed;
    // In object space a mirrored object's front is as any other's.
    const glm::vec3 from(glm::inverse(worldFromObject) * glm::vec4(eye, 1.0f));
    for (size_t i = 0; i + 2 < mesh.indices.size() && area < kLeastArea; i += 3) {
        const glm::vec3 a = vertices[mesh.indices[i]].position, b = vertices[mesh.indices[i + 1]].position,
                        c = vertices[mesh.indices[i + 2]].position;
        if (!material.doubleSided && glm::dot(glm::cross(b - a, c - a), from - a) <= 0.0f)
            continue;
        const auto clip = [&](glm::vec3 p) { return clipFromObject * glm::vec4(p, 1.0f); };
        area += areaSeen(clip(a), clip(b), clip(c));
    }
}

// Without a pose, as the nodes say.
bool seesFrom(const Scene& scene, const Pose& pose, const Camera& camera, float aspect)
{
    const glm::mat4 clipFromWorld = reversedPerspective(camera.yFov, aspect, camera.nearMetres) *
                                    glm::lookAt(camera.eye, camera.target, camera.up);
    float area = 0.0f;
    for (size_t i = 0; i < scene.objects.size() && area < kLeastArea; ++i)
        addArea(scene, i, pose, clipFromWorld, camera.eye, area);
    return area >= kLeastArea;
}

} // namespace

bool seesAnything(const Scene& scene, const Camera& camera, float aspect)
{
    if (seesFrom(scene, {}, camera, aspect))
        return true;
    const Animation& animation = scene.animation;
    for (int i = 0; i < kWayPoints && animation.seconds > 0.0; ++i) {
        const Pose pose = poseAt(animation, animation.seconds * (i + 0.999) / kWayPoints);
        if (seesFrom(scene, pose, moved(camera, pose), aspect))
            return true;
    }
    return false;
}

} // namespace lumel::scene
