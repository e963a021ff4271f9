// The inner loops: gradients, agreement of the instruction sets, and the closed form of <f, f>.
#include "oracle.h"
#include "problem.h"
#include <memory>

namespace lumel::baker {
namespace {

using namespace test;

double errorOf(const Problem& p, float* gradient = nullptr)
{
    float overlap = 0.0f, norm = 0.0f;
    kernels().evaluate(p.job, &overlap, &norm, gradient);
    return 1.0 - double(overlap) * overlap / (double(p.job.energy) * norm);
}

double mixtureErrorAt(Problem& p, const float* unknowns)
{
    std::copy(unknowns, unknowns + kUnknowns, p.job.unknowns);
    SearchSettings once;
    once.isotropic = false;
    once.maxEvaluations = 1;
    FitJob* job = &p.job;
    kernels().minimiseMixtures(&job, 1, once, scratch().data());
    return p.job.error;
}

} // namespace

TEST(Kernel, GradientMatchesFiniteDifferences)
{
    for (unsigned seed = 1; seed <= 50; ++seed) {
        Problem p(seed);
        float gradient[5];
        errorOf(p, gradient);
        for (int j = 0; j < 5; ++j) {
            const float step = j < 2 ? 2e-3f : 1e-2f, at = p.job.unknowns[j];
            p.job.unknowns[j] = at + step;
            const double up = errorOf(p);
            p.job.unknowns[j] = at - step;
            const double down = errorOf(p);
            p.job.unknowns[j] = at;
            const double difference = (up - down) / (2.0 * double(step));
            EXPECT_NEAR(gradient[j], difference, 5e-3 * std::max(0.2, std::abs(difference)))
                << "unknown " << j << " seed " << seed;
        }
    }
}

TEST(Kernel, SearchesEndWhereTheGradientVanishes)
{
    for (unsigned seed = 1; seed <= 50; ++seed) {
        Problem p(seed);
        const double before = errorOf(p);
        SearchSettings settings;
        settings.isotropic = false;
        FitJob* job = &p.job;
        kernels().minimise(&job, 1, settings);
        EXPECT_LE(p.job.error, before + 1e-6);
        float gradient[5];
        EXPECT_NEAR(errorOf(p, gradient), p.job.error, 1e-5);
        for (int j = 0; j < 2; ++j)
            EXPECT_LT(std::abs(gradient[j]) * 0.1f, 5e-3f) << "seed " << seed;
        for (int j = 2; j < 4; ++j)
            if (p.job.unknowns[j] < p.job.maxLog && p.job.unknowns[j] > kLowestLog) {
                EXPECT_LT(std::abs(gradient[j]), 5e-3f) << "seed " << seed;
            }
    }
}

TEST(Kernel, MixtureSearchesEndInAMinimum)
{
    for (unsigned seed = 1; seed <= 30; ++seed) {
        Problem p(seed);
        SearchSettings settings;
        settings.isotropic = false;
        FitJob* job = &p.job;
        kernels().minimiseMixtures(&job, 1, settings, scratch().data());
        std::vector<float> found(p.job.unknowns, p.job.unknowns + kUnknowns);
        const double lowest = p.job.error;
        for (size_t j = 0; j < 5; ++j)
            for (const float step : {-0.03f, 0.03f}) {
                std::vector<float> near = found;
                near[j] += j < 2 ? 0.1f * step : step;
                EXPECT_GE(mixtureErrorAt(p, near.data()), lowest - 1e-5)
                    << "unknown " << j << " seed " << seed;
            }
    }
}

// More jobs than lanes, of different sizes: lanes are refilled, and no job may see another's nodes.
TEST(Kernel, AllInstructionSetsAgreeOnAQueueOfJobs)
{
    constexpr unsigned kJobs = 45;
    for (const Kernels* set : instructionSets())
        for (const bool isotropic : {false, true})
            for (const bool exact : {true, false}) {
                std::vector<std::unique_ptr<Problem>> queue, alone;
                std::vector<FitJob*> jobs;
                for (unsigned seed = 0; seed < kJobs; ++seed) {
                    for (auto* list : {&queue, &alone}) {
                        list->push_back(std::make_unique<Problem>(seed, seed % 3 == 0 ? 16 : 12));
                        list->back()->job.mixtureCount = int(2 + seed % 3);
                    }
                    jobs.push_back(&queue.back()->job);
                }
                SearchSettings settings;
                settings.isotropic = isotropic;
                std::vector<float> memory = scratch();
                std::fill(memory.begin(), memory.end(), std::nanf("")); // previous contents must not matter
                const auto search = [&](const Kernels& k, FitJob* const* list, int count) {
                    if (exact)
                        k.minimise(list, count, settings);
                    else
                        k.minimiseMixtures(list, count, settings, memory.data());
                };
                search(*set, jobs.data(), kJobs);
                for (unsigned seed = 0; seed < kJobs; ++seed) {
                    FitJob* job = &alone[seed]->job;
                    search(kScalarKernels, &job, 1);
                    EXPECT_NEAR(jobs[seed]->error, job->error, 2e-4) << set->name << " job " << seed;
                }
            }
}

// Against the nodes; and against the mixture, whose slopes leave out how weights change.
TEST(Kernel, GradientOfTwoLobesMatchesFiniteDifferences)
{
    std::vector<float> memory = scratch();
    for (const bool exact : {true, false})
        for (unsigned seed = 1; seed <= 30; ++seed) {
            const Problem p(seed);
            const std::vector<float> area = areaOf(p);
            PairJob job = pairJobOf(p, area);
            float gradient[10], unused[10];
            kernels().evaluatePair(job, exact, gradient, memory.data());
            for (int j = 0; j < 10; ++j) {
                float& unknown = job.unknowns[j / 5][j % 5];
                const float step = j % 5 < 2 ? 2e-3f : 1e-2f, at = unknown;
                unknown = at + step;
                const double up = kernels().evaluatePair(job, exact, unused, memory.data());
                unknown = at - step;
                const double down = kernels().evaluatePair(job, exact, unused, memory.data());
                unknown = at;
                const double difference = (up - down) / (2.0 * double(step));
                EXPECT_NEAR(gradient[j], difference,
                            (exact ? 5e-3 : 6e-2) * std::max(0.2, std::abs(difference)))
                    << "unknown " << j << " seed " << seed << (exact ? "" : ", mixture");
            }
        }
}

TEST(Kernel, SearchesForTwoLobesEndInAMinimum)
{
    for (const bool isotropic : {false, true})
        for (unsigned seed = 1; seed <= 20; ++seed) {
            const Problem p(seed);
            const std::vector<float> area = areaOf(p);
            PairJob job = pairJobOf(p, area);
            float gradient[10];
            const double before = kernels().evaluatePair(job, true, gradient, nullptr);
            SearchSettings settings;
            settings.isotropic = isotropic;
            settings.maxEvaluations = 150;
            PairJob* one = &job;
            kernels().minimisePairs(&one, 1, settings);
            EXPECT_NEAR(kernels().evaluatePair(job, true, gradient, nullptr), job.error, 1e-5);
            EXPECT_GE(std::min(job.ks[0], job.ks[1]), 0.0f);
            if (isotropic)
                continue;
            EXPECT_LE(job.error, before + 1e-6);
            for (int j = 0; j < 10; ++j)
                if (j % 5 < 2) { // a lobe's width is about 0.1
                    EXPECT_LT(std::abs(gradient[j]) * 0.1f, 1e-2f) << "seed " << seed;
                }
        }
}

TEST(Kernel, AllInstructionSetsAgreeOnPairs)
{
    constexpr unsigned kJobs = 37;
    std::vector<float> memory = scratch();
    for (const Kernels* set : instructionSets())
        for (const bool exact : {true, false}) {
            std::vector<std::unique_ptr<Problem>> problems;
            std::vector<std::vector<float>> areas;
            std::vector<PairJob> queue;
            for (unsigned seed = 0; seed < kJobs; ++seed) {
                problems.push_back(std::make_unique<Problem>(seed, seed % 3 == 0 ? 16 : 12));
                problems.back()->job.mixtureCount = int(2 + seed % 3);
                areas.push_back(areaOf(*problems.back()));
                queue.push_back(pairJobOf(*problems.back(), areas.back()));
            }
            std::vector<PairJob> alone = queue;
            std::vector<PairJob*> jobs;
            for (PairJob& job : queue)
                jobs.push_back(&job);
            SearchSettings settings;
            settings.isotropic = false;
            std::fill(memory.begin(), memory.end(), std::nanf("")); // previous contents must not matter
            const auto search = [&](const Kernels& k, PairJob* const* list, int count) {
                if (exact)
                    k.minimisePairs(list, count, settings);
                else
                    k.minimisePairMixtures(list, count, settings, memory.data());
            };
            search(*set, jobs.data(), kJobs);
            double difference = 0.0;
            for (unsigned seed = 0; seed < kJobs; ++seed) {
                PairJob* job = &alone[seed];
                search(kScalarKernels, &job, 1);
                difference += std::abs(double(queue[seed].error) - job->error) / kJobs;
            }
            EXPECT_LT(difference, 2e-4) << set->name; // rounding may take a search to another minimum
        }
}

TEST(Kernel, AllInstructionSetsAverageAlike)
{
    Problem p(3);
    std::vector<LobeTerm> lobes;
    for (const MixtureTerm& t : p.terms)
        lobes.push_back({t.nx, t.ny, t.nz, 30.0f, 5.0f, 20.0f, t.amplitude});
    for (const bool isotropic : {true, false}) {
        for (LobeTerm& l : lobes)
            if (isotropic)
                l.pxy = 0.0f, l.pyy = l.pxx;
        std::vector<float> scalar(Problem::kNodes, 0.0f);
        kScalarKernels.average(lobes.data(), int(lobes.size()), isotropic, p.job.nodes, scalar.data());
        // The isotropic short cut and the general form are the same lobe.
        std::vector<float> general(Problem::kNodes, 0.0f);
        kScalarKernels.average(lobes.data(), int(lobes.size()), false, p.job.nodes, general.data());
        for (const Kernels* set : instructionSets()) {
            std::vector<float> wide(Problem::kNodes, 0.0f);
            set->average(lobes.data(), int(lobes.size()), isotropic, p.job.nodes, wide.data());
            for (size_t k = 0; k < wide.size(); ++k) {
                EXPECT_NEAR(wide[k], scalar[k], 1e-5f * scalar[k] + 1e-9f) << set->name;
                EXPECT_NEAR(general[k], scalar[k], 1e-4f * scalar[k] + 1e-7f);
            }
        }
    }
}

TEST(Kernel, ClosedFormOfTheNormMatchesTheIntegral)
{
    Problem p(1);
    const auto check = [&](float nx, float ny, float l1, float l2, float l3) {
        const float values[] = {nx, ny, l1, l2, l3};
        std::copy(values, values + 5, p.job.unknowns);
        float overlap = 0.0f, norm = 0.0f;
        kernels().evaluate(p.job, &overlap, &norm, nullptr);
        const double e1 = std::exp(l1), e2 = std::exp(l2), shear = l3 * e2;
        const double xx = kBase + e1 * e1, xy = e1 * shear, yy = kBase + e2 * e2 + shear * shear,
                     det = xx * yy - xy * xy;
        const test::OracleLobe lobe{nx, ny, yy / det, -xy / det, xx / det, 1.0, 1.0};
        const test::OracleSums sums = test::oracleSums({lobe}, lobe, 800);
        EXPECT_NEAR(norm / sums.ff, 1.0, 2e-3) << nx << " " << ny << " " << l1;
    };
    check(0.0f, 0.0f, 2.0f, 2.0f, 0.0f);
    check(0.3f, -0.4f, 1.5f, 2.5f, 0.7f);
    check(-0.5f, 0.5f, 2.2f, 1.8f, -0.5f);
    check(0.05f, 0.1f, 0.5f, 0.7f, 0.2f);
    // Near the horizon half of the lobe or more lies below it.
    check(0.8f, 0.58f, 1.5f, 1.5f, 0.0f);
    check(-0.7f, 0.7f, 2.3f, 1.5f, 0.4f);
    check(0.2f, 0.975f, 1.2f, 2.4f, -0.3f);
}
} // namespace lumel::baker
