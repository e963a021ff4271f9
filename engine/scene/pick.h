// What a ray meets first: for selecting and inspecting by mouse.
#pragma once
#include "scene.h"

namespace lumel::scene {

struct Ray {
    glm::vec3 origin{0.0f};    // world
    glm::vec3 direction{0.0f}; // any length
};
// Through a point of the picture: (0, 0) its upper left corner, (1, 1) the lower right one.
Ray rayThrough(const Camera& camera, glm::vec2 point, float aspect);

struct Hit {
    size_t object = 0;
    glm::vec3 position{0.0f}; // world
    glm::vec2 uv{0.0f};       // of the material's maps
    float uvPerMetre = 0.0f;  // on the surface, the mean of all directions
    float distance = 0.0f;    // metres
};
// Back faces of single-sided materials let it pass.
std::optional<Hit> pick(const Scene& scene, const Ray& ray);

// An object's box in world space, around the corners of its mesh's.
Bounds worldBounds(const Scene& scene, size_t object);

} // namespace lumel::scene
