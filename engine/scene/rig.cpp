// Default camera and lights for files without.
#include "scene.h"
#include <numbers>

namespace lumel::scene {

Camera frameBounds(const Bounds& bounds, float aspect)
{
    Camera camera;
    camera.name = "frame";
    if (bounds.empty() || !(aspect > 0.0f))
        return camera;
    // glTF's front is +Z: a third to the right, a quarter above.
    const glm::vec3 back = glm::normalize(glm::vec3(0.45f, 0.32f, 1.0f));
    const glm::vec3 right = glm::normalize(glm::cross(camera.up, back));
    const glm::vec3 up = glm::cross(back, right);
    const float tanY = std::tan(0.5f * camera.yFov);
    constexpr float kMargin = 1.08f; // margin around the object
    float distance = 0.0f;
    for (int corner = 0; corner < 8; ++corner) {
        const glm::vec3 p = glm::vec3(corner & 1 ? bounds.upper.x : bounds.lower.x,
                                      corner & 2 ? bounds.upper.y : bounds.lower.y,
                                      corner & 4 ? bounds.upper.z : bounds.lower.z) -
                            bounds.centre();
        const float half = std::max(std::abs(glm::dot(p, up)), std::abs(glm::dot(p, right)) / aspect);
        distance = std::max(distance, glm::dot(p, back) + kMargin * half / tanY);
    }
    // A flat sheet seen edge on, or a single point, still needs space before the near plane.
    const float radius = std::max(bounds.radius(), 1e-6f);
    distance = std::max(distance, 1.1f * radius);
    camera.target = bounds.centre();
    camera.eye = camera.target + distance * back;
    camera.nearMetres = std::max(0.5f * (distance - radius), 0.01f * distance);
    return camera;
}

// Tuned on a white diffuse ball (Kd = 1): with Lo = Ei / pi Kd cos, its brightest point, where the key
// falls straight on it, reaches a radiance of 0.8, its shaded side 0.2. The rim stands low and to the side:
// straight behind, its grazing reflections outshine everything on glossy tops.
std::vector<Light> threeLightRig()
{
    const auto light = [](const char* name, glm::vec3 from, glm::vec3 colour, float lux) {
        Light result;
        result.name = name;
        result.colour = colour;
        result.intensity = lux;
        result.direction = -glm::normalize(from);
        return result;
    };
    return {
        light("key", {0.85f, 0.9f, 0.95f}, {1.0f, 0.94f, 0.84f}, 2.65f),
        light("fill", {-1.0f, -0.1f, 0.7f}, {0.78f, 0.88f, 1.0f}, 0.75f),
        light("rim", {-0.9f, 0.5f, -0.6f}, {0.95f, 0.97f, 1.0f}, 1.2f),
    };
}

// A Fibonacci spiral over the upper half of the sphere around the bounds: equal areas of sky for all.
std::vector<Light> lightRing(int count, const Bounds& bounds)
{
    constexpr float kGolden = float(std::numbers::phi);
    // Candela a square metre: the sum of all lights' illuminances at the centre, before their ranges'
    // falloff.
    constexpr float kTotalLux = 12.0f;
    const float radius = bounds.empty() ? 1.0f : std::max(bounds.radius(), 1e-3f);
    const glm::vec3 centre = bounds.empty() ? glm::vec3(0.0f) : bounds.centre();
    std::vector<Light> lights;
    for (int i = 0; i < count; ++i) {
        const float turn = kGolden * float(i), height = (float(i) + 0.5f) / float(count);
        const float angle = 2.0f * float(std::numbers::pi) * (turn - std::floor(turn));
        const float across = std::sqrt(1.0f - height * height);
        const glm::vec3 outwards(across * std::sin(angle), height, across * std::cos(angle));
        Light light;
        light.name = "ring " + std::to_string(i);
        light.type = i % 2 == 0 ? LightType::point : LightType::spot;
        light.position = centre + radius * outwards;
        light.direction = -outwards;
        light.intensity = kTotalLux * radius * radius / float(count);
        // Point lights reach past the centre, not the far side; spots reach it within their cone.
        light.range = (light.type == LightType::point ? 1.5f : 2.0f) * radius;
        light.innerCone = glm::radians(20.0f);
        light.outerCone = glm::radians(35.0f);
        // Warm to cool around the ring, as bright on the whole as white.
        const float warmth = 0.3f * std::cos(angle);
        light.colour = {1.0f + warmth, 1.0f, 1.0f - warmth};
        lights.push_back(light);
    }
    return lights;
}

} // namespace lumel::scene
