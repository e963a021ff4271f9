// The lattice points around a lobe that is much longer than wide, as of brushed metal.
#pragma once
#include "quadrature.h"
#include "source.h"
#include <array>

namespace lumel::baker {

// Where such a lobe is above exp(-kMargin^2) of its square: along a great circle, which Lambert's map bends,
// as an ellipse in the angles along it and across.
struct Strip {
    glm::vec3 normal, along, across;
    float length, width; // half axes in radians
    float most, least;   // variances along and across

    Strip(const Lobes& lobes, size_t index);
    LatticeCovariance covariance(float spacing) const;
    // Runs of lattice points, counted from the point `centre`; or only about their box.
    void fill(float spacing, glm::vec2 centre, bool boxOnly, Stencil& stencil) const;

private:
    using Outline = std::array<glm::vec2, 2>; // both sides
    Outline outlineAt(float angle, glm::vec3 middle, float spacing, glm::vec2 centre) const;
};

} // namespace lumel::baker
