// A slow reference to compare with: the metallic-roughness BRDF of glTF 2.0, appendix B, with GGX,
// height-correlated Smith masking and multiple scattering.
#pragma once
#include <glm/glm.hpp>

namespace lumel::test {

class GgxReference {
public:
    GgxReference(float perceptualRoughness, glm::vec3 f0, glm::vec3 diffuse);

    // Radiance towards v from a light of irradiance 1 (on a plane facing it) in direction l, times N.l. All
    // unit, in the frame whose z axis is N.
    glm::vec3 reflectLight(glm::vec3 l, glm::vec3 v) const;

private:
    float alpha_;
    glm::vec3 f0_, diffuse_;
    static constexpr int kAngles = 64;
    float single_[kAngles]; // directional albedo of a white metal without multiple scattering, by N.v
};

} // namespace lumel::test
