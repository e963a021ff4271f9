// The judge of `--shading reference`: a slow ray caster that shares nothing with the renderer but the
// reflectance formulas of shaders/shared (lobe.h, shading.h, environment.h). It reads the glTF file itself
// and samples textures at their finest level, with as many rays as requested.
//
// It shares these choices with the renderer, since glTF leaves them open or they are documented limits:
// blended surfaces and those that are emissive all over cast no shadow, point lights cast none, and a
// single-sided surface casts one where its front faces the light.
#pragma once
#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

namespace lumel::judge {

struct Question {
    std::filesystem::path gltf; // with its buffers and images beside it
    glm::uvec2 size;            // pixels
    int rays = 64;              // per pixel
    double seconds = 0.0;       // of the animations
    bool shadows = true;
    glm::vec3 sky{0.0f}, ground{0.0f}; // radiance of the hemispheres where there is no environment
    std::optional<float> environment;  // radiance from everywhere
};

// Linear radiance, row 0 on top.
struct Answer {
    glm::uvec2 size{0};
    std::vector<glm::vec3> radiance;
};

Answer castRays(const Question& question);

} // namespace lumel::judge
