// The talk's picture of the fit: the error over (power, Ks) and the minimiser's path through it.
#pragma once
#include "report_grid.h"
#include "report_measure.h"

namespace lumel::baker {

// A first guess that the path may start from.
struct PathStart {
    std::string name;
    Shape shape;
};

// `average` is G on the grid. The baker's own search is run from each of `starts`; the path is that of
// the worst one which still ends at the fit (or of the one that ends nearest). `starts` empty: no path.
Landscape landscapeOf(const DiscGrid& grid, const std::vector<float>& average, const StoredLobe& fit,
                      const std::vector<PathStart>& starts, bool isotropic, float maxPower);

} // namespace lumel::baker
