// From glTF's parameters at a point to a lobe: the renderer does it in baker/source.cpp and
// engine/scene/material_maps.cpp, the judge here, from the specifications.
#pragma once
#include <glm/glm.hpp>

namespace lumel::judge {

struct Parameters {
    glm::vec3 baseColour{1.0f}; // the diffuse colour where specularGlossiness
    float metallic = 1.0f;
    float roughness = 1.0f; // perceptual
    float ior = 1.5f;
    float specular = 1.0f;                     // KHR_materials_specular: factor and colour
    glm::vec3 specularColour{1.0f};            // the reflectance itself where specularGlossiness
    float anisotropy = 0.0f;                   // strength
    glm::vec2 anisotropyDirection{1.0f, 0.0f}; // along tangent and bitangent, unit
    bool specularGlossiness = false;
};

struct Reflectance {
    glm::vec3 f0;         // reflectance at normal incidence
    glm::vec3 diffuse;    // Kd
    glm::vec3 covariance; // S.xx S.xy S.yy along tangent and bitangent, see shared/lobe.h
};

Reflectance reflectanceOf(const Parameters& parameters);

} // namespace lumel::judge
