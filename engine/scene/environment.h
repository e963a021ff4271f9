// The environment that lights a scene: a map of all directions, and what is made of it once on load.
#pragma once
#include "core/image.h"
#include "scene.h"
#include <array>

namespace lumel::scene {

struct Environment {
    // RGB, square, as shaders/shared/environment.h maps and filters them; level L is kEnvironmentSize >> L.
    std::vector<Image> levels;
    // Coefficients of shared::environmentDiffuse().
    std::array<glm::vec3, 9> diffuse{};
    std::vector<Light> lights; // for scenes without: what is too small and bright for the picture
};

// A direction of an equirectangular map (+Y on top, +X in the middle, +Z right of it) and back;
// (0, 0) is the upper left corner, (1, 1) the lower right one.
glm::vec3 latLongDirection(glm::vec2 place);
glm::vec2 latLongPlace(glm::vec3 direction);

// `picture`: RGB radiance, an equirectangular map.
Environment makeEnvironment(const Image& picture);
// A clear sky over light ground, with its sun as a light.
Environment skyEnvironment();
// Of an equirectangular map, Radiance HDR or OpenEXR. Throws Error naming the file.
Environment loadEnvironment(const std::filesystem::path& file);
// "none", "sky" or a file; empty: a sky where the scene has no lights of its own.
std::shared_ptr<const Environment> chooseEnvironment(const std::string& name, const Scene& scene);

// A level's radiance, filtered as the GPU does; level may lie between two.
glm::vec3 lookUp(const Environment& environment, glm::vec3 direction, float level);

// The scene's lights, or where it has none its environment's, or where it has none either, threeLightRig().
std::vector<Light> lightsOf(const Scene& scene);
std::vector<Light> lightsOf(const Environment* environment); // of a scene without

} // namespace lumel::scene
