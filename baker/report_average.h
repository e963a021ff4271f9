// The exact average of any function of the level-0 lobes under a texel, at given points.
#pragma once
#include "footprint.h"
#include "report_grid.h"
#include <functional>

namespace lumel::baker {

// Sums functions of level-0 lobes. Levels of few texels share sums over cells, the rectangles between the
// borders of all their texels, so that the map is summed once for all of them.
class Averages {
public:
    // Adds `weight` times the function of a lobe at all points to `sums`.
    using AddLobe = std::function<void(const Lobes& lobes, size_t index, float weight, float* sums)>;

    // Keeps references. Levels of at most `sharedTexels` texels share cells.
    Averages(const Source& source, const std::vector<Level>& levels, size_t points, AddLobe add,
             int sharedTexels);
    // Of the reflectance, on a grid of half vectors; Ks is the luminance.
    Averages(const Source& source, const std::vector<Level>& levels, const DiscGrid& grid, int sharedTexels);

    // The average over a texel; `level` counts in `levels`.
    void get(size_t level, int x, int y, float* g) const;

private:
    std::vector<double> borders(int size, size_t firstLevel, int Level::*extent) const;
    void addRectangle(const Footprint& fx, const Footprint& fy, float scale, float* g) const;
    void sumCells();

    const Source& source_;
    const std::vector<Level>& levels_;
    size_t points_;
    AddLobe add_;
    size_t firstShared_;
    std::vector<double> cutsX_, cutsY_; // in level-0 texels
    std::vector<float> cells_;          // [cell][point], weighted by area in level-0 texels
};

} // namespace lumel::baker
