// A glTF material at a point of a surface.
#pragma once
#include "reflectance.h"
#include "texture.h"

namespace lumel::judge {

enum class Alpha { opaque, mask, blend };

struct Material {
    Parameters factors;
    float alpha = 1.0f; // the base colour's
    Texture baseColour, metallicRoughness, normal, occlusion, emission;
    Texture specular, specularColour, anisotropy;
    float normalScale = 1.0f, occlusionStrength = 1.0f, anisotropyRotation = 0.0f;
    glm::vec3 emissive{0.0f};
    Alpha mode = Alpha::opaque;
    float cutoff = 0.5f;
    bool doubleSided = false, unlit = false;

    // colour: of the vertices.
    float alphaAt(const glm::dvec2 uv[2], float colourAlpha) const;
    bool passes(float alphaThere) const { return mode != Alpha::mask || alphaThere >= cutoff; }
    Parameters parametersAt(const glm::dvec2 uv[2], glm::vec3 colour) const;
    glm::vec3 normalAt(const glm::dvec2 uv[2]) const; // in the tangent frame, unit
    float occlusionAt(const glm::dvec2 uv[2]) const;
    glm::vec3 emissionAt(const glm::dvec2 uv[2]) const;
    // Where tangents come from when the file has none.
    const Texture& tangentTexture() const;
};

Material readMaterial(const tinygltf::Model& model, int index);

} // namespace lumel::judge
