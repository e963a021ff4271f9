// The second lobe of texels that one lobe serves badly: three starts or more on the finer level's lobes, a
// few steps on the exact error from where each ends, and more from the best (fit_pair.inl).
#include "profile.h"
#include "shared/lobe.h"
#include "solver.h"
#include <numeric>

namespace lumel::baker {
namespace {

// Where a second lobe is worth its storage: it takes this share off E, and this much.
constexpr float kLeastShare = 0.25f, kLeastGain = 0.005f;
// Evaluations against the finer level's lobes; against the average, from each start and from the best one.
constexpr int kRoughEvaluations = 14, kTrialEvaluations = 4, kExactEvaluations = 8;
// Texels from this level on are few, and have more minima: a start from each of the finer level's lobes.
constexpr int kManyStartsLevel = 4;

struct TwoShapes {
    Shape first, second;
};

Shape onDisc(double x, double y, const Sym2& disc)
{
    const double r2 = x * x + y * y, most = 0.98;
    const double pull = r2 > most * most ? most / std::sqrt(r2) : 1.0;
    const glm::vec3 n = shared::lobeNormal(glm::vec2(float(pull * x), float(pull * y)));
    const Sym2 s = clampPowers(DiscFrame(glm::dvec3(n)).fromDisc(disc));
    return {n.x, n.y, float(s.xx), float(s.xy), float(s.yy)};
}

// One lobe as two, 0.8 deviations to either side along its long axis, with what is left of its covariance.
TwoShapes split(const Shape& lobe)
{
    constexpr double kApart = 0.8;
    const double nz = std::sqrt(std::max(1e-4, 1.0 - double(lobe.nx) * lobe.nx - double(lobe.ny) * lobe.ny));
    const Sym2 c = DiscFrame({lobe.nx, lobe.ny, nz}).toDisc({lobe.sxx, lobe.sxy, lobe.syy});
    const double mean = 0.5 * (c.xx + c.yy), half = 0.5 * (c.xx - c.yy);
    const double deviation = std::sqrt(mean + std::sqrt(half * half + c.xy * c.xy));
    const double angle = 0.5 * std::atan2(2.0 * c.xy, c.xx - c.yy);
    const double dx = kApart * deviation * std::cos(angle), dy = kApart * deviation * std::sin(angle);
    const Sym2 rest = c + Sym2{dx * dx, dx * dy, dy * dy} * -1.0;
    return {onDisc(lobe.nx + dx, lobe.ny + dy, rest), onDisc(lobe.nx - dx, lobe.ny - dy, rest)};
}

// The finer level's lobes under a texel, to start from.
class FinerLobes {
public:
    FinerLobes(const Kernels& kernels, const TexelTask& task, const MixtureTerm* terms, size_t count)
        : kernels_(kernels), task_(task), terms_(terms), withAll_(count), norm_(count), units_(count),
          scratch_(count)
    {
        for (size_t i = 0; i < count; ++i) {
            units_[i] = unitTerm(task.finer(int(i)).shape);
            withAll_[i] = overlapWithAll(units_[i]);
            norm_[i] = normOf(units_[i]);
        }
    }

    size_t count() const { return units_.size(); }
    // The one with the most energy.
    const Shape& strongest() const
    {
        return largest([&](size_t i) {
            const TexelTask::Child& lobe = task_.finer(int(i));
            return lobe.share * lobe.ks * std::sqrt(norm_[i]);
        });
    }
    // The one that a fit lacks most: whose overlap with what the fit leaves is largest, relative to its own
    // norm.
    const Shape& missing(const Shape& fit)
    {
        const MixtureTerm lobe = unitTerm(fit);
        const float ks = overlapWithAll(lobe) / normOf(lobe);
        kernels_.mixtureOverlaps(units_.data(), int(units_.size()), lobe, scratch_.data());
        return largest([&](size_t i) { return (withAll_[i] - ks * scratch_[i]) / std::sqrt(norm_[i]); });
    }

private:
    float overlapWithAll(const MixtureTerm& lobe)
    {
        kernels_.mixtureOverlaps(terms_, int(scratch_.size()), lobe, scratch_.data());
        return std::accumulate(scratch_.begin(), scratch_.end(), 0.0f);
    }
    static float normOf(const MixtureTerm& m) // the closed form of <f, f>
    {
        return 3.14159265f * m.amplitude * m.amplitude * m.nz / std::sqrt(m.sxx * m.syy - m.sxy * m.sxy);
    }
    template<class Score>
    const Shape& largest(const Score& score) const
    {
        size_t best = 0;
        for (size_t i = 1; i < units_.size(); ++i)
            if (score(i) > score(best))
                best = i;
        return task_.finer(int(best)).shape;
    }

    const Kernels& kernels_;
    const TexelTask& task_;
    const MixtureTerm* terms_;
    std::vector<float> withAll_, norm_;
    std::vector<MixtureTerm> units_;
    std::vector<float> scratch_;
};

// K >= 0 of least squares for overlaps g with lobes of this Gram matrix.
struct TwoKs {
    double first, second, explained;
};
TwoKs project(double g1, double g2, const float* norm, double cross)
{
    const double n1 = norm[0], n2 = norm[1], det = n1 * n2 - cross * cross;
    TwoKs k{0.0, 0.0, 0.0};
    if (det > 1e-4 * n1 * n2)
        k = {(g1 * n2 - g2 * cross) / det, (g2 * n1 - g1 * cross) / det, 0.0};
    if (k.first <= 0.0 || k.second <= 0.0) {
        const bool isFirst = g1 * g1 * n2 >= g2 * g2 * n1;
        k = {isFirst ? std::max(0.0, g1 / n1) : 0.0, isFirst ? 0.0 : std::max(0.0, g2 / n2), 0.0};
    }
    k.explained = k.first * g1 + k.second * g2;
    return k;
}

} // namespace

glm::dvec3 pairNormal(const float* t, const float* s)
{
    const double k1 = luminance({t[kKsR], t[kKsG], t[kKsB]}), k2 = luminance({s[kKs2R], s[kKs2G], s[kKs2B]});
    const double share = k2 / std::max(k1 + k2, 1e-30);
    const double x = t[kNx] + share * (double(s[kN2x]) - t[kNx]),
                 y = t[kNy] + share * (double(s[kN2y]) - t[kNy]);
    return {x, y, std::sqrt(std::max(0.0, 1.0 - x * x - y * y))};
}

PairJob Solver::pairJobOf(const PairStart& start, Family family, Against against) const
{
    const Texel& t = texels_[start.texel];
    const size_t n = t.firstNode;
    PairJob job;
    if (t.nodeCount > 0) {
        job.nodes = {int(t.nodeCount), &nodes_.x[n], &nodes_.y[n], &nodes_.z[n], &weight_[n]};
        job.area = &nodes_.area[n];
    }
    const bool whole = against == Against::average && t.nodeCount == 0;
    job.mixture = whole ? listed_.data() + t.firstListed : terms_.data() + t.firstFiner;
    job.mixtureCount = int(whole ? t.listedCount : t.finerCount);
    job.energy = t.energy;
    job.maxLog = t.maxLog;
    for (int i = 0; i < 2; ++i)
        toUnknowns(family == kIsotropic ? isotropicShape(start.shape[i]) : start.shape[i], job.maxLog,
                   job.unknowns[i]);
    return job;
}

// As for one lobe; which of the two lobes is the first does not matter.
size_t Solver::firstAlike(const std::vector<PairStart>& starts, size_t index)
{
    size_t first = index;
    const Shape* const s = starts[index].shape;
    for (size_t i = index; i-- > 0 && starts[i].texel == starts[index].texel;) {
        const Shape* const o = starts[i].shape;
        if ((isAlike(o[0], s[0]) && isAlike(o[1], s[1])) || (isAlike(o[0], s[1]) && isAlike(o[1], s[0])))
            first = i;
    }
    return first;
}

// Searches of at most so many evaluations.
void Solver::runPairs(const std::vector<PairStart>& starts, Family family, Against against, int evaluations,
                      std::vector<FoundPair>& found)
{
    std::vector<PairJob> jobs;
    std::vector<PairJob*> onNodes, onMixtures;
    std::vector<size_t> same(starts.size());
    jobs.resize(starts.size());
    for (size_t i = 0; i < starts.size(); ++i) {
        same[i] = firstAlike(starts, i);
        if (same[i] != i)
            continue;
        PairJob& job = jobs[i] = pairJobOf(starts[i], family, against);
        const bool exact = against == Against::average && job.nodes.count > 0;
        (exact ? onNodes : onMixtures).push_back(&job);
    }
    // As in run().
    std::ranges::stable_sort(onMixtures, std::greater(),
                             [](const PairJob* job) { return job->mixtureCount; });
    if (!onMixtures.empty())
        reserveScratch(onMixtures.front()->mixtureCount);
    SearchSettings settings;
    settings.isotropic = family == kIsotropic;
    settings.maxEvaluations = evaluations;
    kernels_.minimisePairs(onNodes.data(), int(onNodes.size()), settings);
    kernels_.minimisePairMixtures(onMixtures.data(), int(onMixtures.size()), settings, scratch_.data());
    found.resize(starts.size());
    std::vector<PairStart> clampedStarts;
    std::vector<size_t> clampedIndices;
    for (size_t i = 0; i < starts.size(); ++i) {
        if (same[i] != i)
            continue;
        const PairJob& job = jobs[i];
        FoundPair& f =
            found[i] = {{}, {job.ks[0], job.ks[1]}, {job.norm[0], job.norm[1]}, job.cross, job.error};
        bool clamped[2] = {};
        for (int j = 0; j < 2; ++j)
            f.shape[j] = fromUnknowns(job.unknowns[j], job.maxLog, clamped[j]);
        if ((clamped[0] || clamped[1]) && against == Against::average && evaluations > 1) {
            clampedStarts.push_back({starts[i].texel, {f.shape[0], f.shape[1]}});
            clampedIndices.push_back(i);
        }
    }
    if (!clampedStarts.empty()) {
        std::vector<FoundPair> evaluated; // where the search left the limits of a lobe
        runPairs(clampedStarts, family, against, 1, evaluated);
        for (size_t i = 0; i < evaluated.size(); ++i)
            found[clampedIndices[i]] = evaluated[i];
    }
    for (size_t i = 0; i < starts.size(); ++i)
        found[i] = found[same[i]];
}

Solver::FoundPair Solver::swapped(FoundPair p)
{
    std::swap(p.shape[0], p.shape[1]);
    std::swap(p.ks[0], p.ks[1]);
    std::swap(p.norm[0], p.norm[1]);
    return p;
}

// The best of each texel's searches, as a start of another.
std::vector<Solver::PairStart> Solver::bestOf(const std::vector<PairStart>& starts,
                                              const std::vector<FoundPair>& found)
{
    std::vector<PairStart> best;
    float error = kNoError;
    for (size_t i = 0; i < starts.size(); ++i) {
        const bool isFirst = best.empty() || best.back().texel != starts[i].texel;
        if (!isFirst && found[i].error >= error)
            continue;
        if (isFirst)
            best.emplace_back();
        best.back() = {starts[i].texel, {found[i].shape[0], found[i].shape[1]}};
        error = found[i].error;
    }
    return best;
}

// Both lobes of the texels that need them, the stronger one first.
void Solver::fitPairs(const Selection& selection, Family family)
{
    const StepTimer timer(options_.profile, Step::secondLobes);
    const bool automatic = options_.lobes == LobeCount::automatic;
    const float least = automatic ? kLeastGain : std::max(options_.precision, 1e-5f);
    std::vector<PairStart> starts;
    for (const uint32_t t : above(selection, family, least)) {
        const Texel& texel = texels_[t];
        if (!texel.task.second || texel.finerCount == 0 || luminance(texel.task.mean.ks) <= 0.0)
            continue;
        const Shape& single = texel.best[family].shape;
        const TwoShapes apart = split(texel.lean);
        FinerLobes finer(kernels_, texel.task, &terms_[texel.firstFiner], texel.finerCount);
        const Shape strongest = finer.strongest();
        starts.push_back({t, {apart.first, apart.second}});
        starts.push_back({t, {single, finer.missing(single)}});
        starts.push_back({t, {strongest, finer.missing(strongest)}});
        if (texel.task.level >= kManyStartsLevel)
            for (size_t i = 0; i < finer.count(); ++i) {
                const Shape& lobe = texel.task.finer(int(i)).shape;
                if (&lobe != &strongest)
                    starts.push_back({t, {lobe, finer.missing(lobe)}});
            }
    }
    std::vector<FoundPair> found;
    runPairs(starts, family, Against::children, kRoughEvaluations, found);
    for (size_t i = 0; i < starts.size(); ++i) {
        std::ranges::copy(found[i].shape, starts[i].shape);
        Texel& texel = texels_[starts[i].texel];
        if (texel.listedCount > 0 && !isGaussian(found[i], texel.best[family].error))
            addNodes(texel);
    }
    runPairs(starts, family, Against::average, kTrialEvaluations, found);
    starts = bestOf(starts, found);
    runPairs(starts, family, Against::average, kExactEvaluations, found);
    for (size_t i = 0; i < starts.size(); ++i) {
        Texel& texel = texels_[starts[i].texel];
        const float single = texel.best[family].error, both = found[i].error;
        const bool isWorth =
            automatic ? both <= (1.0f - kLeastShare) * single && both <= single - kLeastGain : both < single;
        const bool isTrusted = texel.listedCount == 0 || isGaussian(found[i], single);
        if (isWorth && isTrusted && found[i].ks[0] > 0.0f && found[i].ks[1] > 0.0f)
            texel.pair = found[i].ks[0] >= found[i].ks[1] ? found[i] : swapped(found[i]);
    }
}

// Overlaps of each channel of the average with a lobe.
std::array<double, 3> Solver::channelOverlaps(const Texel& texel, const Shape& shape)
{
    std::array<double, 3> overlaps{};
    if (texel.nodeCount == 0) {
        if (scratch_.size() < texel.listedCount)
            scratch_.resize(texel.listedCount);
        kernels_.mixtureOverlaps(&listed_[texel.firstListed], int(texel.listedCount), unitTerm(shape),
                                 scratch_.data());
        for (size_t i = 0; i < texel.listedCount; ++i) {
            const float* colour = listedLobes_[texel.firstListed + i].ks;
            const double whole = luminance({colour[0], colour[1], colour[2]});
            for (size_t c = 0; c < 3 && whole > 0.0; ++c)
                overlaps[c] += double(scratch_[i]) * double(colour[c]) / whole;
        }
        return overlaps;
    }
    sampleShape(texel, shape);
    for (size_t c = 0; c < 3; ++c)
        for (size_t k = 0; k < texel.nodeCount; ++k)
            overlaps[c] += double(channelWeight_[c][texel.firstNode + k]) * scratch_[k];
    return overlaps;
}

// One colour for both lobes, unless two are clearly better.
void Solver::writePairColours(const Texel& texel, float* first, float* second)
{
    constexpr double kClearly = 0.005; // of what is explained
    const FoundPair& p = texel.pair;
    const auto a = channelOverlaps(texel, p.shape[0]), b = channelOverlaps(texel, p.shape[1]);
    const double k1 = p.ks[0], k2 = p.ks[1];
    const double norm = k1 * k1 * p.norm[0] + 2.0 * k1 * k2 * p.cross + k2 * k2 * p.norm[1];
    double together = 0.0, apart = 0.0;
    std::array<TwoKs, 3> own;
    std::array<double, 3> shared;
    for (size_t c = 0; c < 3; ++c) {
        const double overlap = k1 * a[c] + k2 * b[c];
        shared[c] = overlap / norm;
        own[c] = project(a[c], b[c], p.norm, p.cross);
        together += overlap * overlap / norm;
        apart += own[c].explained;
    }
    const bool useOwn = apart - together > kClearly * apart;
    for (size_t c = 0; c < 3; ++c) {
        first[c] = float(useOwn ? own[c].first : k1 * shared[c]);
        second[c] = float(useOwn ? own[c].second : k2 * shared[c]);
    }
}

void Solver::writePair(const Texel& texel)
{
    const FoundPair& p = texel.pair;
    const TexelTask& task = texel.task;
    float *t = task.texel, *s = task.second;
    const auto writeShape = [](const Shape& shape, float* to) {
        to[kNx] = shape.nx;
        to[kNy] = shape.ny;
        to[kSxx] = shape.sxx;
        to[kSxy] = shape.sxy;
        to[kSyy] = shape.syy;
    };
    writeShape(p.shape[0], t);
    writeShape(p.shape[1], s);
    t[kError] = std::max(0.0f, p.error);
    const double meanKs = luminance(task.mean.ks);
    for (int c = 0; c < 3; ++c) {
        const double colour = task.mean.ks[c] / std::max(meanKs, 1e-30);
        t[kKsR + c] = float(double(p.ks[0]) * colour);
        s[kKs2R + c] = float(double(p.ks[1]) * colour);
    }
    if (coloured_)
        writePairColours(texel, t + kKsR, s + kKs2R);
    writeDiffuse(task, pairNormal(t, s), t);
}

} // namespace lumel::baker
