// A GGX distribution of half vectors as a quadratic form, and nodes at which many are summed at once.
//
// Walter et al. 2007, eq. 33, and its anisotropic form (Burley 2012, appendix B.2) are both
//   D(h) = 1 / (pi at ab (h^T A h)^2),   A = n n^T + t t^T / at^2 + b b^T / ab^2,
// 0 where n.h <= 0. Integrals are over the disc of h.xy, as in the baker's fit.
#pragma once
#include <array>
#include <glm/glm.hpp>
#include <vector>

namespace lumel::baker {

// What a lobe is: alpha along each tangent of its normal.
struct GgxShape {
    glm::vec3 normal{0.0f, 0.0f, 1.0f};
    glm::vec3 tangent{1.0f, 0.0f, 0.0f}; // unit, at right angles to the normal
    float alphaT = 1.0f, alphaB = 1.0f;
};

struct GgxLobe {
    explicit GgxLobe(const GgxShape& shape);
    GgxLobe() = default;
    std::array<float, 6> form{}; // xx yy zz xy xz yz; the last three doubled
    float scale = 0.0f;
    glm::vec3 normal{0.0f, 0.0f, 1.0f};
};

// The half vector at `u` in [0, 1) of the lobe's energy and at an angle around its normal: uniform numbers
// give half vectors in proportion to D(h) (n.h).
glm::vec3 ggxHalfVector(const GgxShape& shape, float u, float angle);

// A fixed number of half vectors.
class GgxNodes {
public:
    static constexpr size_t kCount = 96;
    using Values = std::array<float, kCount>;

    void set(size_t i, glm::vec3 h);
    // values += weight D(h); densities += weight D(h) (n.h) / h.z, with which that lobe's half vectors lie on
    // the disc.
    void add(const GgxLobe& lobe, float weight, Values& values, Values& densities) const;
    // What a display shows of `strength` times the lobe and of a diffuse vector, reflectance times normal,
    // under lights that are the same for any nodes; and of values that are summed already.
    void display(const GgxLobe& lobe, float strength, glm::vec3 diffuse, Values& shown) const;
    static void display(const Values& specular, glm::vec3 diffuse, Values& shown);
    void evaluate(const GgxLobe& lobe, Values& values) const;
    // How often a picture has the half vector, up to a factor: about as often as lights and views that are
    // spread by their cosines. 0 below the horizon.
    float frequency(size_t i) const { return z_[i] > 0.0f ? z_[i] * z_[i] * z_[i] * z_[i] : 0.0f; }

private:
    struct AtNode {
        float value, cosine;
    };
    AtNode at(const GgxLobe& lobe, size_t i) const;
    alignas(64) std::array<Values, 6> products_{}; // of h with itself, in the form's order
    alignas(64) Values x_{}, y_{}, z_{}, inverseZ_{};
};

} // namespace lumel::baker
