// A glTF file at a moment of its animations: triangles, lights and a camera in world space.
#pragma once
#include "material.h"
#include <filesystem>

namespace lumel::judge {

struct Corner {
    glm::dvec3 position, normal, tangent, bitangent;
    glm::dvec2 uv[2];
    glm::dvec4 colour{1.0};
};

struct Triangle {
    Corner corners[3];
    glm::dvec3 front; // away from its front side, not unit
    int material;
};

// KHR_lights_punctual.
struct Light {
    std::string type;
    glm::dvec3 position, direction; // the way the light travels
    glm::dvec3 intensity;           // colour times lux or candela
    double range = 0.0, innerCone = 0.0, outerCone = 0.0;
};

struct Camera {
    glm::dmat4 worldFromCamera{1.0}; // looks along its -Z
    double yFov = 0.7;
};

struct Model {
    std::vector<Triangle> triangles;
    std::vector<Material> materials; // the last one is glTF's default
    std::vector<Light> lights;
    Camera camera; // the file's first
};

Model readModel(const std::filesystem::path& file, double seconds);

} // namespace lumel::judge
