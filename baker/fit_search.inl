// BFGS, all lanes at once.

// Inverse Hessian, lower triangle: h[i][j], j <= i.
struct Hessian {
    V h[5][5];
    LUMEL_INLINE V at(int i, int j) const { return i >= j ? h[i][j] : h[j][i]; }
};

// Nocedal and Wright, "Numerical Optimization" (2006), eq. 6.17, expanded for a symmetric H:
// H += (1 + y^T H y / s^T y) s s^T / s^T y - (H y s^T + s y^T H) / s^T y. Lanes outside `mask` keep H.
LUMEL_INLINE void updateHessian(Hessian& hessian, const V* s, const V* y, I mask, int n)
{
    V sy{}, yHy{}, hy[5];
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

// The searches of all lanes: one texel a lane, each at its own point.
template<class Objective>
struct Search {
    const Objective& objective;
    const int n; // unknowns
    V x[5], f, g[5];
    V direction[5], step, slope;
    Hessian hessian;
    I active; // lanes still searching
    I fresh;  // lanes that need a new direction

    Search(const Objective& o, const float* start, bool isotropic) : objective(o), n(isotropic ? 3 : 5)
    {
        x[0] = x[1] = V{};
        for (int i = 2; i < 5; ++i)
            x[i] = load(start + (kL1 + i - 2) * W);
        f = objective(x, g);
        step = slope = V{};
        for (int i = 0; i < 5; ++i)
            direction[i] = V{};
        hessian = Hessian{};
        resetHessian(I{} == 0);
        active = fresh = f < 2.0f;
    }

    // Near a good fit the error is a paraboloid of curvature 1 in the scaled unknowns, 2 where one
    // unknown widens the lobe both ways.
    LUMEL_INLINE void resetHessian(I mask)
    {
        for (int i = 0; i < n; ++i)
            for (int j = 0; j <= i; ++j) {
                const float value = i != j ? 0.0f : n == 3 && i == 2 ? 0.5f : 1.0f;
                hessian.h[i][j] = mask ? splat(value) : hessian.h[i][j];
            }
    }

    // New directions -H g for the fresh lanes, no step longer than one unit in any unknown.
    LUMEL_INLINE void chooseDirections()
    {
        constexpr float kLongestStep = 1.0f;
        V candidate[5], slopeNew, longest;
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
        V trial[5], trialG[5], s[5], y[5], largest{};
        for (int i = 0; i < n; ++i)
            trial[i] = x[i] + step * direction[i];
        const V trialF = objective(trial, trialG);
        const I accepted = active & (trialF <= f + kArmijo * step * slope);
        for (int i = 0; i < n; ++i) {
            s[i] = trial[i] - x[i];
            y[i] = trialG[i] - g[i];
        }
        updateHessian(hessian, s, y, accepted, n);
        for (int i = 0; i < n; ++i) {
            x[i] = accepted ? trial[i] : x[i];
            g[i] = accepted ? trialG[i] : g[i];
            largest = maximum(largest, magnitude(g[i]));
        }
        // The parabola through f, its slope and the trial has its minimum here.
        const V parabola = -0.5f * slope * step * step / maximum(trialF - f - slope * step, splat(1e-20f));
        const I small = accepted & (f - trialF < 1e-2f * tolerance) & (step >= 0.99f);
        f = accepted ? trialF : f;
        step = accepted ? step : minimum(maximum(parabola, 0.1f * step), 0.5f * step);
        active &= ~(small | (largest < tolerance) | (step < 1e-3f));
        fresh = accepted;
    }
};

template<class Objective>
void searchLanes(const FitProblem& problem, float* unknowns, float* error)
{
    const auto row = [&](int i) { return load(unknowns + i * W); };
    const Objective objective{problem,
                              {row(kX), row(kY), row(kB11), row(kB21), row(kB22), problem.isotropic}};
    Search<Objective> search(objective, unknowns, problem.isotropic);
    for (int evaluation = 1; evaluation < problem.maxEvaluations && any(search.active); ++evaluation) {
        search.chooseDirections();
        search.advance(problem.tolerance);
    }
    const Scaling& scaling = objective.scaling;
    const V* x = search.x;
    store(unknowns + kX * W, scaling.originX + scaling.b11 * x[0]);
    store(unknowns + kY * W, scaling.originY + scaling.b21 * x[0] + scaling.b22 * x[1]);
    store(unknowns + kL1 * W, x[2]);
    store(unknowns + kL2 * W, problem.isotropic ? x[2] : x[3]);
    store(unknowns + kL3 * W, problem.isotropic ? V{} : x[4]);
    store(error, search.f);
}

void minimise(const FitProblem& problem, float* unknowns, float* error)
{
    searchLanes<ExactObjective>(problem, unknowns, error);
}

void minimiseMixture(const FitProblem& problem, float* unknowns, float* error)
{
    searchLanes<MixtureObjective>(problem, unknowns, error);
}
