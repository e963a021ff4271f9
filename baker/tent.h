// The bilinear footprint: the weight that a bilinear lookup gives a texel, as a function of where it looks,
// is a tent two texels wide. Fitting a texel to the average under its tent instead of its box makes the
// interpolated lobes, not the stored ones, match the surface (the talk's closing thought).
#pragma once
#include "bake.h"
#include <algorithm>

namespace lumel::baker {

struct TentShare {
    int cell;    // beyond the border of a repeating axis: below 0 or from the count on
    float share; // of the tent's mass
};

// Integral of the unit tent from -1 to t.
inline double tentMass(double t)
{
    t = std::clamp(t, -1.0, 1.0);
    return t < 0.0 ? 0.5 * (1.0 + t) * (1.0 + t) : 1.0 - 0.5 * (1.0 - t) * (1.0 - t);
}

// Shares of texel x of `coarseSize` texels in the cells of an axis of `size` level-0 texels. border(i) is
// the lower border of cell i of `count`; cellAt(position) the cell that holds a position.
template<class Border, class CellAt>
void tentShares(int x, int coarseSize, int size, Wrap wrap, int count, const Border& border,
                const CellAt& cellAt, std::vector<TentShare>& shares)
{
    const double half = double(size) / coarseSize, centre = (x + 0.5) * half;
    const auto mass = [&](double from, double to) {
        return float(tentMass((to - centre) / half) - tentMass((from - centre) / half));
    };
    shares.clear();
    for (int period = -1; period <= 1; ++period) {
        const double shift = double(period) * size;
        const double from = std::max(centre - half, shift), to = std::min(centre + half, shift + size);
        if (to - from < 1e-9)
            continue;
        if (period != 0 && wrap == Wrap::clamp) {
            shares.push_back({period < 0 ? 0 : count - 1, mass(from, to)});
            continue;
        }
        for (int i = cellAt(from - shift); i < count && border(i) + shift < to - 1e-7; ++i)
            shares.push_back({i + period * count,
                              mass(std::max(from, border(i) + shift), std::min(to, border(i + 1) + shift))});
    }
}

} // namespace lumel::baker
