// The exact average reflectance of any texel on the report's grid.
#pragma once
#include "footprint.h"
#include "report_grid.h"

namespace lumel::baker {

// Sums level-0 lobes on the grid. Levels of few texels share sums over cells, the rectangles between the
// borders of all their texels, so that the map is not summed anew for each of them.
class Averages {
public:
    // Keeps references. Levels of at most `sharedTexels` texels share cells.
    Averages(const Source& source, const std::vector<Level>& levels, const DiscGrid& grid, int sharedTexels);

    // G of a texel; `level` counts in `levels`.
    void get(size_t level, int x, int y, float* g) const;

private:
    std::vector<double> borders(int size, size_t firstLevel, int Level::*extent) const;
    void addRectangle(const Footprint& fx, const Footprint& fy, float scale, float* g) const;
    void sumCells();

    const Source& source_;
    const std::vector<Level>& levels_;
    const DiscGrid& grid_;
    size_t firstShared_;
    std::vector<double> cutsX_, cutsY_; // in level-0 texels
    std::vector<float> cells_;          // [cell][point], weighted by area in level-0 texels
};

} // namespace lumel::baker
