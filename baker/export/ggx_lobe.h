// A GGX distribution of half vectors as a quadratic form, and nodes at which many are summed at once.
//
// Walter et al. 2007, eq. 33, and its anisotropic form (Burley 2012, appendix B.2) are both
//   D(h) = 1 / (pi at ab (h^T A h)^2),   A = n n^T + t t^T / at^2 + b b^T / ab^2,
// 0 where n.h <= 0. Integrals are over the disc of h.xy, as in the baker's fit.
#pragma once
#include "ggx_kernel.h"
#include <array>
#include <glm/glm.hpp>
#include <span>

namespace lumel::baker {

// What a lobe is: alpha along each tangent of its normal.
struct GgxShape {
    glm::vec3 normal{0.0f, 0.0f, 1.0f};
    glm::vec3 tangent{1.0f, 0.0f, 0.0f}; // unit, at right angles to the normal
    float alphaT = 1.0f, alphaB = 1.0f;
};

// `strength` times D.
GgxTerm ggxTerm(const GgxShape& shape, float strength = 1.0f);

// A fixed number of half vectors, each with the direction of a light: a third each from lobes that place() is
// given, from one that is broad, and evenly from the disc.
class GgxNodes {
public:
    static constexpr size_t kCount = kGgxNodes, kPart = kGgxPart;
    struct alignas(64) Values : std::array<float, kCount> {};
    using Lobes = std::array<const GgxShape*, kPart>;

    GgxNodes();
    // One half vector from each of the lobes, with densities proportional to D(h) (n.h).
    void place(const Lobes& lobes, const GgxShape& broad);
    glm::vec3 half(size_t i) const { return {arrays_.h[0][i], arrays_.h[1][i], arrays_.h[2][i]}; }

    // values += the terms; densities += those with which the lobes' half vectors lie on the disc.
    void add(std::span<const GgxTerm> terms, Values& values, Values& densities) const;
    // What a display shows of specular values and of a diffuse vector, reflectance times normal.
    void display(const Values& specular, glm::vec3 diffuse, Values& shown) const;
    // Weights by which nodes of these densities are summed, with how often a picture has the half vector;
    // returns the sum of shown^2.
    double weigh(const Values& densities, const Values& shown, Values& weights) const;
    // The weighted sum of squared differences to what a display shows of a lobe.
    double error(const GgxTerm& lobe, glm::vec3 diffuse, const Values& shown, const Values& weights) const;

private:
    GgxNodeArrays arrays_;
    GgxDraws draws_;
};

} // namespace lumel::baker
