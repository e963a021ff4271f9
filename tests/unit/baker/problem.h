// Searches for the tests of the kernels, and the kernels that this processor runs.
#pragma once
#include "baker/fit_kernel.h"
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace lumel::baker::test {

// A search: four Gaussian bumps near each other as the mixture, and their sum on a lattice of nodes.
struct Problem {
    static constexpr int kNodes = 256;
    std::vector<float> x, y, z, weight;
    std::vector<MixtureTerm> terms;
    FitJob job;

    explicit Problem(unsigned seed, int side = 16)
    {
        std::mt19937 random(seed);
        std::uniform_real_distribution<float> uniform(-1.0f, 1.0f);
        const float mx = 0.3f * uniform(random), my = 0.3f * uniform(random);
        for (int i = 0; i < 4; ++i) {
            const float nx = mx + 0.1f * uniform(random), ny = my + 0.1f * uniform(random);
            terms.push_back({nx, ny, std::sqrt(1.0f - nx * nx - ny * ny), 0.03f, 0.01f * uniform(random),
                             0.02f, 0.2f * (1.2f + uniform(random))});
        }
        const float step = 0.9f / float(side);
        double energy = 0.0;
        for (int k = 0; k < side * side; ++k) {
            x.push_back(mx + (float(k % side) + 0.5f) * step - 0.45f);
            y.push_back(my + (float(k / side) + 0.5f) * step - 0.45f);
            z.push_back(std::sqrt(1.0f - x.back() * x.back() - y.back() * y.back()));
            float g = 0.0f;
            for (const MixtureTerm& t : terms) {
                const float dx = x.back() - t.nx, dy = y.back() - t.ny;
                const float q = t.syy * dx * dx - 2.0f * t.sxy * dx * dy + t.sxx * dy * dy;
                const float det = t.sxx * t.syy - t.sxy * t.sxy;
                g += t.amplitude * std::exp(-0.5f * q / det) / std::sqrt(det);
            }
            weight.push_back(step * step * g);
            energy += double(weight.back()) * g;
        }
        job.nodes = {side * side, x.data(), y.data(), z.data(), weight.data()};
        job.mixture = terms.data();
        job.mixtureCount = int(terms.size());
        job.energy = float(energy);
        job.maxLog = 4.0f;
        const float start[kUnknowns] = {mx + 0.03f,
                                        my - 0.02f,
                                        1.6f + 0.3f * uniform(random),
                                        1.8f + 0.3f * uniform(random),
                                        0.5f * uniform(random),
                                        0.1f,
                                        0.01f,
                                        0.12f};
        std::copy(start, start + kUnknowns, job.unknowns);
    }
    Problem(const Problem&) = delete;
};

inline std::vector<float> scratch()
{
    return std::vector<float>(size_t(Problem::kNodes) * 8 * kMaxLanes);
}

// Two lobes against a problem's average: one at its start, one to its other side.
inline PairJob pairJobOf(const Problem& p, const std::vector<float>& area)
{
    PairJob job;
    job.nodes = p.job.nodes;
    job.area = area.data();
    job.mixture = p.job.mixture;
    job.mixtureCount = p.job.mixtureCount;
    job.energy = p.job.energy;
    job.maxLog = p.job.maxLog;
    for (int i = 0; i < 2; ++i)
        std::copy(p.job.unknowns, p.job.unknowns + kUnknowns, job.unknowns[i]);
    job.unknowns[1][kX] -= 0.12f;
    job.unknowns[1][kY] += 0.06f;
    job.unknowns[1][kL1] += 0.3f;
    job.unknowns[1][kL3] -= 0.2f;
    return job;
}

inline std::vector<float> areaOf(const Problem& p)
{
    const float side = std::sqrt(float(p.job.nodes.count));
    return std::vector<float>(size_t(p.job.nodes.count), 0.9f * 0.9f / (side * side));
}

inline std::vector<const Kernels*> instructionSets()
{
    std::vector<const Kernels*> sets = {&kBaselineKernels, &kernels()};
#if defined(__x86_64__)
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
        sets.push_back(&kAvx2Kernels);
#endif
    return sets;
}

} // namespace lumel::baker::test
