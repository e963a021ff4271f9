// Which level-0 texels a texel of level L covers, and how much of each.
#pragma once
#include <algorithm>
#include <cmath>

namespace lumel::baker {

inline int levelSize(int size, int level)
{
    return std::max(1, size >> level);
}

inline int levelCount(int width, int height)
{
    int count = 1;
    while ((std::max(width, height) >> count) > 0)
        ++count;
    return count;
}

// Texels of level 0 from `first` to `last` (exclusive) on one axis. Sizes that are not powers of two
// make a texel cover fractions of level-0 texels: weight(i) is the covered length, at most 1.
struct Footprint {
    double begin = 0.0;
    double end = 0.0;
    int first = 0;
    int last = 0;

    // Texel x of `coarseSize` texels over an axis of `size` level-0 texels.
    Footprint(int x, int coarseSize, int size)
        : Footprint(double(x) * size / coarseSize, double(x + 1) * size / coarseSize)
    {
    }
    Footprint(double from, double to) : begin(from), end(to)
    {
        // Borders that differ from an integer only by rounding are that integer.
        const auto snap = [](double v) { return std::abs(v - std::round(v)) < 1e-7 ? std::round(v) : v; };
        begin = snap(begin);
        end = snap(end);
        first = int(std::floor(begin));
        last = int(std::ceil(end));
    }
    float weight(int i) const { return float(std::min(end, i + 1.0) - std::max(begin, double(i))); }
};

} // namespace lumel::baker
