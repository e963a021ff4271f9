// Where to sample the disc of half vectors. The average G of a texel's lobes is a sum of bumps; nodes
// go where the bumps are, about one per lobe width, because the trapezoidal rule converges
// exponentially for such functions once its spacing falls below the width (Trefethen and Weideman
// 2014, "The exponentially convergent trapezoidal rule").
#pragma once
#include "core/uninitialised.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/glm.hpp>
#include <vector>

namespace lumel::baker {

// Nodes as arrays; pad() appends nodes of no area, one at least, up to a multiple of the widest vector.
struct NodeSet {
    UninitialisedArray<float> x, y, z; // unit half vectors
    UninitialisedArray<float> area;    // of the disc
    size_t size() const { return x.size(); }
    void clear();
    void resize(size_t count);
    void add(float nx, float ny, float nz, float nodeArea);
    void pad();
};

// Which nodes a sum is taken on: the points (i, j) * spacing in Lambert's azimuthal equal-area map of the
// hemisphere, or a rule for the whole disc where lobes are broad. Lambert's map keeps lobes nearly round at
// any tilt and has no singularity at the rim: h.xy = l sqrt(1 - |l|^2 / 4), h.z = 1 - |l|^2 / 2, and
// dx dy = h.z dl.
struct Nodes {
    float spacing = 0.0f;
    const NodeSet* rule = nullptr;
    bool operator==(const Nodes&) const = default;
};

// The points of a lattice with (x i + y j) mod step = 0, one in `step`, which divides kMaxStep.
class Sublattice {
public:
    static constexpr int kMaxStep = 4;
    // Of a row, every `stride`th point from the first one that is not before i; stride 0: none.
    struct Row {
        int stride = 0, first = 0;
        int from(int i) const { return i + ((first - i) & (stride - 1)); }
    };
    constexpr Sublattice() : Sublattice(1, 0, 0) {} // all
    constexpr Sublattice(int step_, int x_, int y_) : step(step_), x(x_), y(y_)
    {
        for (int j = 0; j < kMaxStep; ++j)
            for (int i = step - 1; i >= 0; --i) // a row's points are equally far apart
                if (has(i, j))
                    rows_[size_t(j)] = {rows_[size_t(j)].stride == 0 ? step : rows_[size_t(j)].first - i, i};
    }
    constexpr bool has(int i, int j) const { return ((x * i + y * j) & (step - 1)) == 0; }
    const Row& row(int j) const { return rows_[size_t(j & (kMaxStep - 1))]; }
    int step, x, y;

private:
    std::array<Row, kMaxStep> rows_{};
};

// Covariance of a lobe in Lambert's map, in spacings.
struct LatticeCovariance {
    float xx, xy, yy;
    float least; // the smaller eigenvalue
};
// The coarsest that sums all these lobes as well as the whole lattice.
Sublattice sublatticeFor(const std::vector<LatticeCovariance>& lobes);

// Spacing in standard deviations of a lobe. Products of two equal lobes have a Fourier transform
// exp(-(w sigma)^2 / 4): the rule's error is 4 exp(-pi^2) = 2e-4 of them.
inline constexpr double kSpacing = 1.0;
// Up to this power lobes reach the rim of the disc, where a lattice ends abruptly; the product rule
// (Gauss-Legendre in h.z, trapezoidal in the angle) covers the disc without an edge.
inline constexpr double kDiscRulePower = 14.0;
// Up to this power the same rule serves where a lobe reaches the rim because it is tilted.
inline constexpr double kRimRulePower = 80.0;
// Most lattice points of one sum. Lobes too narrow for that are sampled too sparsely for their own sake,
// which only shows where few of them stand alone.
inline constexpr int kMaxNodes = 4096;

const NodeSet& discRule(double power);

// Lattice points around a lobe, row by row; the coordinates are padded to whole vectors.
struct Stencil {
    struct Run {
        int y, x, count, stride = 1;
    };
    std::vector<Run> runs;
    UninitialisedArray<float> x, y;
    glm::ivec2 lower{0}, upper{0}; // the box of the runs, `upper` beyond it
    void clear() { runs.clear(); }
    // Coordinates and box of the runs.
    void place();
};
inline constexpr float kMostReach = 32.5f; // radius of the largest stencil
const Stencil& stencilFor(float radius);   // in spacings

inline glm::vec2 lambert(float nx, float ny, float nz)
{
    const float g = std::sqrt(2.0f / (1.0f + nz));
    return {nx * g, ny * g};
}

// Radius of a lobe's support in Lambert's map, which stretches it by up to 1 / cos(theta / 2);
// `lowestPower` is the smaller eigenvalue of its precision. Beyond lies exp(-kMargin^2) = 4e-5 of its square.
inline constexpr float kMargin = 3.2f;
inline float supportRadius(float nz, float lowestPower)
{
    return std::min(2.9f, kMargin * std::sqrt(2.0f / ((1.0f + nz) * lowestPower)));
}

} // namespace lumel::baker
