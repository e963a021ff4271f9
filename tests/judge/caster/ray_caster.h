// The judge of `--shading reference`: a slow ray caster that shares nothing with the renderer but the
// reflectance formulas of shaders/shared (lobe.h, shading.h, environment.h). It reads the glTF file itself
// and looks textures up at their finest level, in as many rays as are asked for.
//
// What it takes over from the renderer, since glTF leaves it open or the README names it as a limit: blended
// surfaces and those that emissive all over cast no shadow, nor do point lights; a single-sided surface casts
// one where its front meets the light.
#pragma once
#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

namespace lumel::judge {

struct Question {
    std::filesystem::path gltf; // with its buffers and images beside it
    glm::uvec2 size;            // pixels
    int rays = 64;              // a pixel
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
