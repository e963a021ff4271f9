// BFGS, all lanes at once.

// Inverse Hessian of up to N unknowns, lower triangle: h[i][j], j <= i.
template<int N>
struct Hessian {
    V h[N][N];
    LUMEL_INLINE V at(int i, int j) const { return i >= j ? h[i][j] : h[j][i]; }
};

// Nocedal and Wright, "Numerical Optimization" (2006), eq. 6.17, expanded for a symmetric H:
// H += (1 + y^T H y / s^T y) s s^T / s^T y - (H y s^T + s y^T H) / s^T y. Lanes outside `mask` keep H.
template<int N>
LUMEL_INLINE void updateHessian(Hessian<N>& hessian, const V* s, const V* y, I mask, int n)
{
    V sy{}, yHy{}, hy[N];
    for (int i = 0; i < n; ++i) {
        sy += s[i] * y[i];
        hy[i] = V{};
        for (int j = 0; j < n; ++j)
            hy[i] += hessian.at(i, j) * y[j];
        yHy += y[i] * hy[i];
    }
    // Without enough curvature along the step the update would lose positive definiteness: skip it.
    const I good = mask & (sy > 1e-8f);
    const V inverse = good ? 1.0f / sy : V{};
    const V scale = (1.0f + yHy * inverse) * inverse;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j <= i; ++j)
            hessian.h[i][j] += scale * s[i] * s[j] - inverse * (hy[i] * s[j] + s[i] * hy[j]);
}

// The searches of all lanes: one job a lane, each at its own point.
template<class Objective>
struct Search {
    using Job = typename Objective::Job;
    static constexpr int N = Objective::kMostUnknowns;
    Objective objective;
    typename Objective::Scaling scaling{};
    const int n; // unknowns
    V x[N]{}, f{}, g[N]{};
    typename Objective::Result result{}; // at x
    V direction[N]{}, step{}, slope{};
    Hessian<N> hessian{};
    I active{}; // lanes at work
    I fresh{};  // lanes that need a new direction
    I first{};  // lanes that evaluate their start

    Search(const Objective& of, bool isotropic) : objective(of), n(isotropic ? N / 5 * 3 : N)
    {
        scaling.idle(isotropic);
    }

    void start(int lane, const Job& job)
    {
        scaling.start(lane, job, x);
        for (int i = 0; i < N; ++i)
            g[i][lane] = direction[i][lane] = 0.0f;
        f[lane] = 1e30f;
        step[lane] = 1.0f;
        slope[lane] = 0.0f;
        active[lane] = first[lane] = -1;
        fresh[lane] = 0; // its start is the first trial
    }

    void finish(int lane, Job& job) const
    {
        scaling.finish(lane, x, job);
        job.error = f[lane];
        result.finish(lane, job);
    }

    // Near a good fit the error is a paraboloid of curvature 1 in a lobe's scaled unknowns, 2 where one
    // unknown widens the lobe both ways.
    LUMEL_INLINE void resetHessian(I mask)
    {
        const int ofLobe = n == N ? 5 : 3;
        for (int i = 0; i < n; ++i)
            for (int j = 0; j <= i; ++j) {
                const float value = i != j ? 0.0f : n < N && i % ofLobe == 2 ? 0.5f : 1.0f;
                hessian.h[i][j] = mask ? value * scaling.flatness(i / ofLobe, result) : hessian.h[i][j];
            }
    }

    // New directions -H g for the fresh lanes, no step longer than one unit in any unknown.
    LUMEL_INLINE void chooseDirections()
    {
        constexpr float kLongestStep = 1.0f;
        V candidate[N], slopeNew, longest;
        for (int pass = 0; pass < 2; ++pass) {
            slopeNew = longest = V{};
            for (int i = 0; i < n; ++i) {
                candidate[i] = V{};
                for (int j = 0; j < n; ++j)
                    candidate[i] -= hessian.at(i, j) * g[j];
                slopeNew += candidate[i] * g[i];
                longest = maximum(longest, magnitude(candidate[i]));
            }
            const I uphill = fresh & (slopeNew >= 0.0f);
            if (!any(uphill))
                break;
            resetHessian(uphill);
        }
        step = fresh ? minimum(splat(1.0f), kLongestStep / maximum(longest, splat(1e-20f))) : step;
        slope = fresh ? slopeNew : slope;
        for (int i = 0; i < n; ++i)
            direction[i] = fresh ? candidate[i] : direction[i];
    }

    // One evaluation: the step is taken where it gains enough (Armijo), else shortened.
    LUMEL_INLINE void advance(float tolerance)
    {
        constexpr float kArmijo = 1e-4f;
        V trial[N], trialG[N], s[N], y[N], largest{};
        for (int i = 0; i < N; ++i)
            trial[i] = i < n ? x[i] + step * direction[i] : V{};
        scaling.bound(trial);
        const V trialF = objective(scaling, trial, trialG);
        const I accepted = active & ((trialF <= f + kArmijo * step * slope) | first);
        for (int i = 0; i < n; ++i) {
            s[i] = trial[i] - x[i];
            y[i] = trialG[i] - g[i];
        }
        updateHessian(hessian, s, y, accepted & ~first, n);
        for (int i = 0; i < n; ++i) {
            x[i] = accepted ? trial[i] : x[i];
            g[i] = accepted ? trialG[i] : g[i];
            largest = maximum(largest, magnitude(g[i]));
        }
        // The parabola through f, its slope and the trial has its minimum here.
        const V parabola = -0.5f * slope * step * step / maximum(trialF - f - slope * step, splat(1e-20f));
        const I small = accepted & (f - trialF < tolerance * tolerance) & (step >= 0.99f);
        const I offDisc = first & (trialF > 2.0f);
        f = accepted ? trialF : f;
        result.take(accepted, objective.result);
        resetHessian(first);
        step = accepted ? step : minimum(maximum(parabola, 0.1f * step), 0.5f * step);
        active &= ~(small | (largest < tolerance) | (step < 1e-3f) | offDisc);
        fresh = accepted;
        first = I{};
    }
};

// Feeds jobs to the lanes until all are done.
template<class Objective>
void runJobs(typename Objective::Job* const* jobs, int count, const SearchSettings& settings,
             const Objective& objective)
{
    const FlushToZero flush;
    Search<Objective> search(objective, settings.isotropic);
    int next = 0, running[W], evaluations[W];
    for (int lane = 0; lane < W; ++lane)
        running[lane] = -1;
    for (;;) {
        bool busy = false;
        for (int lane = 0; lane < W; ++lane) {
            const bool done =
                running[lane] >= 0 && (!search.active[lane] || evaluations[lane] >= settings.maxEvaluations);
            if (done) {
                search.finish(lane, *jobs[running[lane]]);
                search.active[lane] = 0;
                search.objective.drop(lane);
                running[lane] = -1;
            }
            if (running[lane] < 0 && next < count) {
                search.objective.take(lane, *jobs[next]);
                search.start(lane, *jobs[next]);
                running[lane] = next++;
                evaluations[lane] = 0;
            }
            if (running[lane] >= 0) {
                busy = true;
                ++evaluations[lane];
            }
        }
        if (!busy)
            return;
        search.chooseDirections();
        search.advance(settings.tolerance);
    }
}

void minimise(FitJob* const* jobs, int count, const SearchSettings& settings)
{
    runJobs(jobs, count, settings, ExactObjective());
}

void minimiseMixtures(FitJob* const* jobs, int count, const SearchSettings& settings, float* scratch)
{
    runJobs(jobs, count, settings, MixtureObjective(scratch));
}

void evaluate(const FitJob& job, float* overlap, float* norm, float* gradient)
{
    const FlushToZero flush;
    ExactObjective objective;
    objective.take(0, job);
    const auto row = [&](int i) { return splat(job.unknowns[i]); };
    const Lobe lobe = makeLobe(splat(job.maxLog), row(kX), row(kY), row(kL1), row(kL2), row(kL3));
    const Sums sum = objective.sum(lobe);
    const Overlap o = overlapOf(lobe, sum, objective.jobs.busy);
    *overlap = o.gf[0];
    *norm = o.ff[0];
    if (!gradient)
        return;
    V g[5];
    gradientOf(lobe, slopesOf(lobe, sum, o), o.gf * o.gf / (job.energy * o.ff), g);
    for (int i = 0; i < 5; ++i)
        gradient[i] = g[i][0];
}

void minimisePairs(PairJob* const* jobs, int count, const SearchSettings& settings)
{
    runJobs(jobs, count, settings, PairObjective());
}

void minimisePairMixtures(PairJob* const* jobs, int count, const SearchSettings& settings, float* scratch)
{
    runJobs(jobs, count, settings, PairMixtureObjective(scratch));
}

template<class Objective>
float evaluatePairWith(Objective objective, const PairJob& job, float* gradient)
{
    const FlushToZero flush;
    PairScaling scaling{};
    scaling.idle(false);
    V x[10]{}, g[10];
    PairJob unscaled = job;
    for (float* unknowns : unscaled.unknowns) {
        unknowns[kB11] = unknowns[kB22] = 1.0f;
        unknowns[kB21] = 0.0f;
    }
    for (int lane = 0; lane < W; ++lane)
        scaling.start(lane, unscaled, x);
    objective.take(0, job);
    const V error = objective(scaling, x, g);
    for (int i = 0; i < 10; ++i)
        gradient[i] = g[i][0];
    return error[0];
}

float evaluatePair(const PairJob& job, bool exact, float* gradient, float* scratch)
{
    return exact ? evaluatePairWith(PairObjective(), job, gradient)
                 : evaluatePairWith(PairMixtureObjective(scratch), job, gradient);
}
