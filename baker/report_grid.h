// A dense square grid over the disc of half vectors: the report measures errors on it by brute force,
// independently of the nodes the fits were made with.
#pragma once
#include "fit_kernel.h"
#include "moments.h"

namespace lumel::baker {

// How narrow the level-0 lobes are on the disc: standard deviations along their narrow axes.
struct Narrowness {
    double least = 1.0;           // of all lobes
    double firstPercentile = 1.0; // 1 % of the lobes are narrower
};
Narrowness narrowness(const Source& source);

class DiscGrid {
public:
    // At least `side` points per side; rounded up to whole vectors of the kernels.
    explicit DiscGrid(int side);

    int side() const { return side_; }
    size_t size() const { return area_.size(); }
    double spacing() const { return 2.0 / side_; }
    const std::vector<float>& area() const { return area_; }
    const std::vector<float>& x() const { return x_; }
    const std::vector<float>& y() const { return y_; }
    const std::vector<float>& z() const { return z_; }

    // g += scale * (lobe of Ks 1). Points where the lobe is below 1e-6 of its peak are left out.
    void add(const Shape& shape, float scale, float* g) const;
    double integral(const float* f, const float* g) const; // of f g over the disc

private:
    int side_;
    const Kernels& kernels_;
    std::vector<float> x_, y_, z_, area_; // half vectors and the area of the disc in each cell
};

// Points per side that resolve lobes of this width: no more than 0.6 deviations apart for all but the
// narrowest hundredth, 1.6 for those. The sum over points of a Gaussian's square, spaced h deviations, is
// its integral to a relative exp(-(pi / h)^2): 1e-12 and 0.02.
int gridSide(const Narrowness& narrow);

} // namespace lumel::baker
