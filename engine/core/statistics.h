// Figures of many measurements.
#pragma once
#include <vector>

namespace lumel {

// Nearest-rank percentile: the smallest value that at least the share p, in (0, 1], of all values does not
// exceed. `values` is not empty.
double percentile(std::vector<double> values, double p);

// A value and the range that holds it in 95 of 100 repetitions.
struct Spread {
    double value = 0.0, low = 0.0, high = 0.0;
};

// percentile(b, p) / percentile(a, p). The range comes from resampling (bootstrap) blocks of neighbouring
// values, because frames are like their neighbours; blocks of the same place of a and b are drawn together,
// because both lists show the same path. Values > 0. The same from every call.
Spread percentileRatio(const std::vector<double>& a, const std::vector<double>& b, double p);

} // namespace lumel
