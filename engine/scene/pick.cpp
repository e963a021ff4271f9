#include "pick.h"
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

namespace lumel::scene {
namespace {

struct Nearest {
    float distance = std::numeric_limits<float>::max(); // in the ray's directions
    size_t object = 0, triangle = 0;
    glm::vec2 barycentric{0.0f};
    void add(const Nearest& other)
    {
        if (other.distance < distance)
            *this = other;
    }
};

bool meetsBox(const Ray& ray, const Bounds& box, float nearest)
{
    float from = 0.0f, to = nearest;
    for (int axis = 0; axis < 3; ++axis) {
        const float inverse = 1.0f / ray.direction[axis];
        float a = (box.lower[axis] - ray.origin[axis]) * inverse;
        float b = (box.upper[axis] - ray.origin[axis]) * inverse;
        if (std::isnan(a) || std::isnan(b)) // along a face
            continue;
        if (a > b)
            std::swap(a, b);
        from = std::max(from, a);
        to = std::min(to, b);
    }
    return from <= to;
}

// Moeller and Trumbore 1997, "Fast, Minimum Storage Ray/Triangle Intersection".
bool meetsTriangle(const Ray& ray, glm::vec3 a, glm::vec3 b, glm::vec3 c, bool bothSides, Nearest& nearest)
{
    const glm::vec3 ab = b - a, ac = c - a, p = glm::cross(ray.direction, ac);
    const float det = glm::dot(ab, p); // > 0: the front is seen
    if (det == 0.0f || (!bothSides && det < 0.0f))
        return false;
    const glm::vec3 s = ray.origin - a, q = glm::cross(s, ab);
    const float u = glm::dot(s, p) / det, v = glm::dot(ray.direction, q) / det, t = glm::dot(ac, q) / det;
    if (u < 0.0f || v < 0.0f || u + v > 1.0f || t <= 0.0f || t >= nearest.distance)
        return false;
    nearest.distance = t;
    nearest.barycentric = {u, v};
    return true;
}

Nearest pickMesh(const Scene& scene, size_t object, const Ray& worldRay, float distance)
{
    const Object& o = scene.objects[object];
    const Mesh& mesh = scene.meshes[size_t(o.mesh)];
    const glm::mat4 objectFromWorld = glm::inverse(o.worldFromObject);
    // Directions keep their length ratio, so distances along the ray are the same in both spaces.
    const Ray ray{glm::vec3(objectFromWorld * glm::vec4(worldRay.origin, 1.0f)),
                  glm::vec3(objectFromWorld * glm::vec4(worldRay.direction, 0.0f))};
    Nearest start{.distance = distance, .object = object};
    if (!meetsBox(ray, objectBounds(scene, object), distance))
        return start;
    const std::vector<Vertex> deformed = deformedVertices(scene, o.deformed);
    const std::vector<Vertex>& vertices = deformed.empty() ? mesh.vertices : deformed;
    const bool bothSides = scene.materials[size_t(o.material)].doubleSided;
    return tbb::parallel_reduce(
        tbb::blocked_range<size_t>(0, mesh.indices.size() / 3, 4096), start,
        [&](const auto& range, Nearest nearest) {
            for (size_t i = range.begin(); i < range.end(); ++i) {
                const auto corner = [&](size_t k) { return vertices[mesh.indices[3 * i + k]].position; };
                // Rays are in object space: there, a mirrored object's front is as any other's.
                if (meetsTriangle(ray, corner(0), corner(1), corner(2), bothSides, nearest))
                    nearest.triangle = i;
            }
            return nearest;
        },
        [](Nearest a, const Nearest& b) {
            a.add(b);
            return a;
        });
}

} // namespace

Ray rayThrough(const Camera& camera, glm::vec2 point, float aspect)
{
    const glm::vec3 forward = glm::normalize(camera.target - camera.eye);
    const glm::vec3 right = glm::normalize(glm::cross(forward, camera.up));
    const glm::vec3 up = glm::cross(right, forward);
    const float tangent = std::tan(0.5f * camera.yFov);
    return {camera.eye, forward + (2.0f * point.x - 1.0f) * tangent * aspect * right +
                            (1.0f - 2.0f * point.y) * tangent * up};
}

std::optional<Hit> pick(const Scene& scene, const Ray& ray)
{
    Nearest nearest;
    for (size_t i = 0; i < scene.objects.size(); ++i)
        nearest.add(pickMesh(scene, i, ray, nearest.distance));
    if (nearest.distance == std::numeric_limits<float>::max())
        return std::nullopt;
    const Object& object = scene.objects[nearest.object];
    const Mesh& mesh = scene.meshes[size_t(object.mesh)];
    const std::vector<Vertex> deformed = deformedVertices(scene, object.deformed);
    const std::vector<Vertex>& vertices = deformed.empty() ? mesh.vertices : deformed;
    const auto corner = [&](size_t k) -> const Vertex& {
        return vertices[mesh.indices[3 * nearest.triangle + k]];
    };
    const glm::vec3 weights(1.0f - nearest.barycentric.x - nearest.barycentric.y, nearest.barycentric);
    Hit hit;
    hit.object = nearest.object;
    hit.position = ray.origin + nearest.distance * ray.direction;
    hit.distance = nearest.distance * glm::length(ray.direction);
    hit.uv = weights.x * corner(0).materialUv + weights.y * corner(1).materialUv +
             weights.z * corner(2).materialUv;
    const auto world = [&](size_t k) {
        return glm::vec3(object.worldFromObject * glm::vec4(corner(k).position, 1.0f));
    };
    const float area = glm::length(glm::cross(world(1) - world(0), world(2) - world(0)));
    const glm::vec2 uvA = corner(1).materialUv - corner(0).materialUv,
                    uvB = corner(2).materialUv - corner(0).materialUv;
    const float uvArea = std::abs(uvA.x * uvB.y - uvA.y * uvB.x);
    hit.uvPerMetre = area > 0.0f ? std::sqrt(uvArea / area) : 0.0f;
    return hit;
}

Bounds worldBounds(const Scene& scene, size_t object)
{
    const Object& o = scene.objects[object];
    const Bounds box = objectBounds(scene, object);
    Bounds bounds;
    for (int corner = 0; corner < 8; ++corner)
        bounds.add(o.worldFromObject * glm::vec4(corner & 1 ? box.upper.x : box.lower.x,
                                                 corner & 2 ? box.upper.y : box.lower.y,
                                                 corner & 4 ? box.upper.z : box.lower.z, 1.0f));
    return bounds;
}

} // namespace lumel::scene
