// What a search finds is its own: the same bits alone and beside any other searches. Otherwise a bake would
// change with the size of a batch or the order of its texels.
#include "problem.h"
#include <bit>
#include <memory>
#include <numeric>

namespace lumel::baker {
namespace {
using namespace test;

using Bits = std::vector<uint32_t>;

Bits bitsOf(std::initializer_list<float> values)
{
    Bits bits;
    for (const float value : values)
        bits.push_back(std::bit_cast<uint32_t>(value));
    return bits;
}

Bits bitsOf(const FitJob& job)
{
    const float* u = job.unknowns;
    return bitsOf({u[kX], u[kY], u[kL1], u[kL2], u[kL3], job.error, job.norm});
}

Bits bitsOf(const PairJob& job)
{
    Bits bits = bitsOf({job.error, job.cross, job.ks[0], job.ks[1], job.norm[0], job.norm[1]});
    for (const float* u : job.unknowns)
        for (const uint32_t b : bitsOf({u[kX], u[kY], u[kL1], u[kL2], u[kL3]}))
            bits.push_back(b);
    return bits;
}

Bits bitsOf(const Trial& trial)
{
    return bitsOf({trial.error, trial.norm});
}

// Searches of different sizes. Every third starts with a lobe so broad that the rim of the disc cuts it.
struct Queue {
    static constexpr unsigned kJobs = 41;
    std::vector<std::unique_ptr<Problem>> problems;
    std::vector<std::vector<float>> areas;
    std::vector<FitJob> jobs;
    std::vector<PairJob> pairs;
    std::vector<Trial> trials;

    Queue()
    {
        for (unsigned seed = 0; seed < kJobs; ++seed) {
            problems.push_back(std::make_unique<Problem>(seed, seed % 2 == 0 ? 16 : 12));
            Problem& p = *problems.back();
            p.job.mixtureCount = int(2 + seed % 3);
            if (seed % 3 == 0)
                p.job.unknowns[kL1] = p.job.unknowns[kL2] = 0.2f;
            areas.push_back(areaOf(p));
            jobs.push_back(p.job);
            pairs.push_back(pairJobOf(p, areas.back()));
            const float power = seed % 3 == 0 ? 2.0f : 16.5f;
            trials.push_back(
                {p.job.nodes, p.job.energy, -0.2f, 0.58f, power, 0.1f * power, 0.8f * power, 1.0f, 1.0f});
        }
    }
};

// As they are, backwards, and without those that the rim cuts at their start.
std::vector<std::vector<size_t>> orders()
{
    std::vector<size_t> forwards(Queue::kJobs), narrow;
    std::iota(forwards.begin(), forwards.end(), size_t(0));
    for (size_t i = 0; i < Queue::kJobs; ++i)
        if (i % 3 != 0)
            narrow.push_back(i);
    return {forwards, {forwards.rbegin(), forwards.rend()}, narrow};
}

// `search` on copies of the jobs, each alone and then in every order.
template<class Job, class SearchAll>
void expectTheSameBits(const std::vector<Job>& jobs, const SearchAll& search, const char* what)
{
    std::vector<Bits> alone;
    for (const Job& job : jobs) {
        std::vector<Job> one = {job};
        search(one);
        alone.push_back(bitsOf(one.front()));
    }
    for (const std::vector<size_t>& order : orders()) {
        std::vector<Job> queue;
        for (const size_t i : order)
            queue.push_back(jobs[i]);
        search(queue);
        size_t different = 0;
        for (size_t i = 0; i < order.size(); ++i)
            different += bitsOf(queue[i]) != alone[order[i]];
        EXPECT_EQ(different, 0u) << "of " << order.size() << " jobs, " << what;
    }
}

template<class Job>
std::vector<Job*> pointersTo(std::vector<Job>& jobs)
{
    std::vector<Job*> pointers;
    for (Job& job : jobs)
        pointers.push_back(&job);
    return pointers;
}

// A search at quadrature nodes and one on mixtures, of all instruction sets.
template<class Job, class AtNodes, class OnMixtures>
void expectTheSameBitsOfSearches(const std::vector<Job>& all, AtNodes Kernels::*atNodes,
                                 OnMixtures Kernels::*onMixtures)
{
    std::vector<float> memory = scratch();
    for (const Kernels* set : instructionSets())
        for (const bool exact : {true, false})
            for (const bool isotropic : {false, true}) {
                SearchSettings settings;
                settings.isotropic = isotropic;
                const auto search = [&](std::vector<Job>& jobs) {
                    const std::vector<Job*> queued = pointersTo(jobs);
                    if (exact)
                        (set->*atNodes)(queued.data(), int(queued.size()), settings);
                    else
                        (set->*onMixtures)(queued.data(), int(queued.size()), settings, memory.data());
                };
                expectTheSameBits(all, search, set->name);
            }
}

} // namespace

TEST(Lanes, SearchesForOneLobeDoNotDependOnEachOther)
{
    expectTheSameBitsOfSearches(Queue().jobs, &Kernels::minimise, &Kernels::minimiseMixtures);
}

TEST(Lanes, SearchesForTwoLobesDoNotDependOnEachOther)
{
    expectTheSameBitsOfSearches(Queue().pairs, &Kernels::minimisePairs, &Kernels::minimisePairMixtures);
}

TEST(Lanes, LobesAreJudgedOnTheirOwn)
{
    const Queue queue;
    for (const Kernels* set : instructionSets())
        expectTheSameBits(
            queue.trials, [&](std::vector<Trial>& trials) { set->judge(trials.data(), int(trials.size())); },
            set->name);
}

} // namespace lumel::baker
