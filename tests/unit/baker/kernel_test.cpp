// The inner loops: gradients, agreement of the instruction sets, and the closed form of <f, f>.
#include "baker/fit_kernel.h"
#include "oracle.h"
#include <random>

namespace lumel::baker {
namespace {

// A random problem of `lanes` texels: a few lobes averaged on random nodes.
struct Random {
    explicit Random(const Kernels& k, unsigned seed) : kernels(k), lanes(size_t(k.lanes))
    {
        std::mt19937 random(seed);
        std::uniform_real_distribution<float> uniform(-1.0f, 1.0f);
        const auto fill = [&](std::vector<float>& v, size_t rows) {
            v.assign(rows * kMaxLanes, 0.0f), v.resize(rows * lanes);
        };
        for (auto* v : {&x, &y, &z, &weight})
            fill(*v, kNodes);
        fill(unknowns, kUnknowns);
        // The same numbers for every lane count: lane l of a wide kernel is problem l of the scalar one.
        for (size_t l = 0; l < kMaxLanes; ++l) {
            const float mx = 0.3f * uniform(random), my = 0.3f * uniform(random);
            float values[kUnknowns] = {mx + 0.03f,
                                       my - 0.02f,
                                       1.6f + 0.3f * uniform(random),
                                       1.8f + 0.3f * uniform(random),
                                       0.5f * uniform(random),
                                       0.1f,
                                       0.01f,
                                       0.12f};
            for (size_t j = 0; j < kUnknowns && l < lanes; ++j)
                unknowns[j * lanes + l] = values[j];
            for (size_t k = 0; k < kNodes; ++k) {
                const float nx = mx + 0.4f * uniform(random), ny = my + 0.4f * uniform(random);
                const float w = 0.01f * (1.0f + uniform(random));
                if (l < lanes) {
                    x[k * lanes + l] = nx;
                    y[k * lanes + l] = ny;
                    z[k * lanes + l] = std::sqrt(1.0f - nx * nx - ny * ny);
                    weight[k * lanes + l] = w;
                }
            }
        }
        energy.assign(kMaxLanes, 0.5f);
        maxLog.assign(kMaxLanes, 4.0f);
        problem.nodes = {int(kNodes), x.data(), y.data(), z.data(), weight.data()};
        problem.energy = energy.data();
        problem.maxLog = maxLog.data();
        problem.isotropic = false;
    }
    void run()
    {
        overlap.resize(kMaxLanes), norm.resize(kMaxLanes), gradient.resize(5 * kMaxLanes);
        kernels.evaluate(problem, unknowns.data(), overlap.data(), norm.data(), gradient.data());
    }
    double error(size_t lane) const
    {
        return 1.0 - double(overlap[lane]) * overlap[lane] / (double(energy[lane]) * norm[lane]);
    }
    static constexpr size_t kNodes = 50;
    const Kernels& kernels;
    size_t lanes;
    std::vector<float> x, y, z, weight, unknowns, energy, maxLog, overlap, norm, gradient;
    FitProblem problem;
};
} // namespace

TEST(Kernel, GradientMatchesFiniteDifferences)
{
    for (unsigned seed = 1; seed <= 5; ++seed) {
        Random r(kernels(), seed);
        r.run();
        const std::vector<float> gradient = r.gradient;
        for (size_t j = 0; j < 5; ++j) {
            const float step = j < 2 ? 2e-3f : 1e-2f;
            const std::vector<float> start = r.unknowns;
            std::vector<double> up(r.lanes), down(r.lanes);
            for (size_t l = 0; l < r.lanes; ++l)
                r.unknowns[j * r.lanes + l] += step;
            r.run();
            for (size_t l = 0; l < r.lanes; ++l)
                up[l] = r.error(l);
            for (size_t l = 0; l < r.lanes; ++l)
                r.unknowns[j * r.lanes + l] = start[j * r.lanes + l] - step;
            r.run();
            for (size_t l = 0; l < r.lanes; ++l)
                down[l] = r.error(l);
            r.unknowns = start;
            for (size_t l = 0; l < r.lanes; ++l) {
                const double difference = (up[l] - down[l]) / (2.0 * double(step));
                EXPECT_NEAR(gradient[j * r.lanes + l], difference, 5e-3 * std::max(0.2, std::abs(difference)))
                    << "unknown " << j << " lane " << l;
            }
        }
    }
}

TEST(Kernel, AllInstructionSetsAgree)
{
    std::vector<const Kernels*> sets = {&kBaselineKernels};
    if (&kernels() != &kBaselineKernels)
        sets.push_back(&kernels());
#if defined(__x86_64__)
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
        sets.push_back(&kAvx2Kernels);
#endif
    // One scalar run a lane.
    for (const Kernels* set : sets) {
        Random wide(*set, 3);
        std::vector<float> error(kMaxLanes);
        wide.run();
        const std::vector<float> start = wide.unknowns;
        set->minimise(wide.problem, wide.unknowns.data(), error.data());
        for (size_t l = 0; l < wide.lanes; ++l) {
            Random one(kScalarKernels, 3);
            for (size_t k = 0; k < Random::kNodes; ++k) {
                one.x[k] = wide.x[k * wide.lanes + l];
                one.y[k] = wide.y[k * wide.lanes + l];
                one.z[k] = wide.z[k * wide.lanes + l];
                one.weight[k] = wide.weight[k * wide.lanes + l];
            }
            for (size_t j = 0; j < kUnknowns; ++j)
                one.unknowns[j] = start[j * wide.lanes + l];
            one.run();
            EXPECT_NEAR(one.overlap[0], wide.overlap[l], 1e-5f * wide.overlap[l]) << set->name;
            EXPECT_NEAR(one.norm[0], wide.norm[l], 1e-5f * wide.norm[l]) << set->name;
            for (size_t j = 0; j < 5; ++j)
                EXPECT_NEAR(one.gradient[j], wide.gradient[j * wide.lanes + l], 1e-4f) << set->name;
            float scalarError = 0.0f;
            kScalarKernels.minimise(one.problem, one.unknowns.data(), &scalarError);
            EXPECT_NEAR(scalarError, error[l], 1e-4f) << set->name << " lane " << l;
        }
    }
}

TEST(Kernel, ClosedFormOfTheNormMatchesTheIntegral)
{
    Random r(kScalarKernels, 1);
    const auto check = [&](float nx, float ny, float l1, float l2, float l3) {
        const float values[] = {nx, ny, l1, l2, l3};
        std::copy(values, values + 5, r.unknowns.begin());
        r.run();
        const double e1 = std::exp(l1), e2 = std::exp(l2), shear = l3 * e2;
        const double xx = 1 + e1 * e1, xy = e1 * shear, yy = 1 + e2 * e2 + shear * shear,
                     det = xx * yy - xy * xy;
        const test::OracleLobe lobe{nx, ny, yy / det, -xy / det, xx / det, 1.0, 1.0};
        const test::OracleSums sums = test::oracleSums({lobe}, lobe, 800);
        EXPECT_NEAR(r.norm[0] / sums.ff, 1.0, 2e-3) << nx << " " << ny << " " << l1;
    };
    check(0.0f, 0.0f, 2.0f, 2.0f, 0.0f);
    check(0.3f, -0.4f, 1.5f, 2.5f, 0.7f);
    check(-0.5f, 0.5f, 2.2f, 1.8f, -0.5f);
    check(0.05f, 0.1f, 0.5f, 0.7f, 0.2f);
}
} // namespace lumel::baker
