#include "statistics.h"
#include <algorithm>
#include <cassert>
#include <cmath>
#include <random>

namespace lumel {

double percentile(std::vector<double> values, double p)
{
    assert(!values.empty());
    // 1e-9: 0.95 * 100 is a little more than 95 in binary.
    const auto rank = size_t(std::ceil(p * double(values.size()) - 1e-9));
    const auto nth = values.begin() + std::ptrdiff_t(std::clamp<size_t>(rank, 1, values.size()) - 1);
    std::nth_element(values.begin(), nth, values.end());
    return *nth;
}

Spread percentileRatio(const std::vector<double>& a, const std::vector<double>& b, double p)
{
    constexpr size_t kBlock = 10; // values
    constexpr int kRepetitions = 1000;
    const size_t blocks = (std::max(a.size(), b.size()) + kBlock - 1) / kBlock;
    std::mt19937 random(1);
    std::vector<double> ratios, fromA(a.size()), fromB(b.size());
    for (int i = 0; i < kRepetitions; ++i) {
        std::vector<double> starts(blocks);
        for (double& start : starts)
            start = double(random()) / (double(std::mt19937::max()) + 1.0);
        const auto resample = [&](const std::vector<double>& from, std::vector<double>& to) {
            for (size_t k = 0; k < to.size(); ++k)
                to[k] = from[(size_t(starts[k / kBlock] * double(from.size())) + k % kBlock) % from.size()];
            return percentile(to, p);
        };
        const double below = resample(a, fromA);
        ratios.push_back(resample(b, fromB) / below);
    }
    return {percentile(b, p) / percentile(a, p), percentile(ratios, 0.025), percentile(ratios, 0.975)};
}

} // namespace lumel
