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
    // Runs of points of the sublattice, counted from the point `centre`.
    void fill(float spacing, glm::vec2 centre, const Sublattice& sub, Stencil& stencil) const;
    // Their box alone, roughly.
    void findBox(float spacing, glm::vec2 centre, Stencil& stencil) const;

private:
    static constexpr int kAlong = 13; // points of a side
    struct Outline {
        float sine[2 * kAlong], out[2 * kAlong]; // of their angles along and across
        float x[2 * kAlong], y[2 * kAlong];      // in spacings from the centre
    };
    Outline outline(float spacing, glm::vec2 centre) const;
    float reach(float spacing) const; // angle to either end
};

} // namespace lumel::baker
