// Error of a lobe F = Ks f against the average G over the unit disc (design, "half-angle
// refactoring"): with Ks* = <G,f>/<f,f> (linear least squares)
//     E / <G,G> = 1 - <G,f>^2 / (<G,G> <f,f>).
// <G,f> is a sum over quadrature nodes. <f,f> needs none: in the lobe's own frame, e = (a, b) with
// s = |e|^2, f^2 = det P exp(-2 q k(s)) = det P (1 - s)^(e^T P e / s), and h.z averages to N.z (the
// tangential part is odd), so with g(phi) = the power along phi
//     <f,f> = N.z det P int dphi int_0^1 (1 - r^2)^g r dr = N.z det P int dphi / (2 (g + 1))
//           = N.z pi det P / sqrt(det(P + I)),
// exact but for the part of the lobe that the rim of the disc cuts off (fit_rim.inl).

// A half vector from a lobe: f / sqrt(det P) to the power of `exponent`, and what ln f changes with: c k P e +
// c k' q e by a tilt, k e e^T by P.
struct PointTerms {
    V f, alpha, beta, maa, mab, mbb;
};

LUMEL_INLINE PointTerms termsAt(const Point& p, const Lobe& lobe, float exponent)
{
    const V pa = lobe.pxx * p.a + lobe.pxy * p.b, pb = lobe.pxy * p.a + lobe.pyy * p.b;
    const V q = p.a * pa + p.b * pb;
    const V f = p.c > 0.0f ? exponential(-exponent * q * p.k) : V{};
    const V u1 = 1.0f + p.u;
    const V slope = 0.25f * q * u1 * u1 * u1 * (p.t + 2.0f * u1 * p.v * areaTangentSlope(p.v));
    const V ck = p.c * p.k, ka = p.k * p.a;
    return {f, ck * pa + slope * p.a, ck * pb + slope * p.b, ka * p.a, ka * p.b, p.k * p.b * p.b};
}

// Sums over nodes of weight * f times 1 and those.
struct Sums {
    V one, alpha, beta, maa, mab, mbb;
};

LUMEL_INLINE void accumulateSlopes(Sums& sum, const PointTerms& p, V weighted)
{
    sum.alpha += weighted * p.alpha;
    sum.beta += weighted * p.beta;
    sum.maa += weighted * p.maa;
    sum.mab += weighted * p.mab;
    sum.mbb += weighted * p.mbb;
}

LUMEL_INLINE void accumulate(Sums& sum, const PointTerms& p, V weight)
{
    const V weighted = weight * p.f;
    sum.one += weighted;
    accumulateSlopes(sum, p, weighted);
}

// Nodes are summed a vector at a time, for one lane's job after the other: jobs differ in their nodes, and lanes
// without a job cost nothing.
LUMEL_INLINE Lobe broadcast(const Lobe& lobe, int lane)
{
    Lobe one;
    const Frame& f = lobe.frame;
    one.frame = {splat(f.nx[lane]), splat(f.ny[lane]), splat(f.nz[lane]), splat(f.r[lane]),
                 splat(f.inverseR[lane])};
    one.pxx = splat(lobe.pxx[lane]);
    one.pxy = splat(lobe.pxy[lane]);
    one.pyy = splat(lobe.pyy[lane]);
    return one;
}

LUMEL_INLINE void reduce(const Sums& vectors, int lane, Sums& sums)
{
    sums.one[lane] = total(vectors.one);
    sums.alpha[lane] = total(vectors.alpha);
    sums.beta[lane] = total(vectors.beta);
    sums.maa[lane] = total(vectors.maa);
    sums.mab[lane] = total(vectors.mab);
    sums.mbb[lane] = total(vectors.mbb);
}

LUMEL_INLINE Sums sumNodes(const NodeList& nodes, const Lobe& lobe)
{
    Sums sum{};
    for (int k = 0; k < nodes.count; k += W) {
        const Point p = locate(lobe.frame, load(nodes.x + k), load(nodes.y + k), load(nodes.z + k));
        accumulate(sum, termsAt(p, lobe, 1.0f), load(nodes.weight + k));
    }
    return sum;
}

#include "fit_rim.inl"

struct Overlap {
    V gf, ff; // <G, f>, <f, f>
    V closed; // the closed form's share of <f, f>
    Sums rim; // and what the rim adds, over <f, f>
};

// The lanes in `busy` count. What a lane finds must not depend on the others' lobes, so the rim adds to those
// lanes only where it matters.
LUMEL_INLINE Overlap overlapOf(const Lobe& lobe, const Sums& sum, I busy)
{
    constexpr float kPi = 3.14159265f;
    const V closed = kPi * lobe.frame.nz * lobe.det / squareRoot(lobe.detPlus);
    Overlap o{squareRoot(lobe.det) * sum.one, closed, splat(1.0f), {}};
    const I cut = busy & rimMatters(lobe);
    if (any(cut)) {
        o.rim = sumRim(lobe);
        o.ff = cut ? closed + lobe.det * o.rim.one : closed;
        o.closed = cut ? closed / o.ff : splat(1.0f);
        const V share = lobe.det / o.ff;
        V* const sums[] = {&o.rim.alpha, &o.rim.beta, &o.rim.maa, &o.rim.mab, &o.rim.mbb};
        for (V* entry : sums)
            *entry = cut ? *entry * share : V{};
    }
    return o;
}

// In the frame, a tilt moves a half vector by da = -alpha c, db = -beta c, a twist by da = gamma b,
// db = -gamma a; d ln f = -2 k (P e).de - 2 k' q e.de. <f,f> changes with N.z only.
LUMEL_INLINE LogSlopes slopesOf(const Lobe& lobe, const Sums& sum, const Overlap& o)
{
    const Frame& f = lobe.frame;
    // ln<G,f>^2 - ln<f,f>: sums of f weigh 2 / <.>, those of f^2 over the lune -2 / <f,f>.
    const V inverse = 2.0f / maximum(sum.one, splat(1e-30f));
    const Sums& rim = o.rim;
    const V maa = sum.maa * inverse - 2.0f * rim.maa, mab = sum.mab * inverse - 2.0f * rim.mab;
    const V mbb = sum.mbb * inverse - 2.0f * rim.mbb;
    LogSlopes d;
    d.alpha = 2.0f * (sum.alpha * inverse - 2.0f * rim.alpha);
    d.beta = 2.0f * (sum.beta * inverse - 2.0f * rim.beta);
    d.gamma = -2.0f * (lobe.pxy * (mbb - maa) + (lobe.pxx - lobe.pyy) * mab);
    // d ln N.z = (alpha Tu.z + beta Tv.z) / N.z, Tu.z = -N.x N.z / r, Tv.z = -N.y / r.
    d.alpha += o.closed * f.nx * f.inverseR;
    d.beta += o.closed * f.ny * f.inverseR / f.nz;
    // d/dP: ln<G,f>^2 gives P^-1 - 2 M / <.>; ln<f,f> gives P^-1 - (P + I)^-1 / 2 in its closed part and
    // P^-1 - 2 M in the lune.
    const V inversePlus = o.closed * 0.5f / lobe.detPlus;
    d.pxx = (lobe.pyy + 1.0f) * inversePlus - maa;
    d.pxy = -lobe.pxy * inversePlus - mab;
    d.pyy = (lobe.pxx + 1.0f) * inversePlus - mbb;
    return d;
}

// The lanes' jobs, none where a lane idles.
template<class Job>
struct LaneJobs {
    const Job* of[W] = {};
    I busy{};

    void take(int lane, const Job& job)
    {
        of[lane] = &job;
        busy[lane] = -1;
    }
    void drop(int lane)
    {
        of[lane] = nullptr;
        busy[lane] = 0;
    }
};

// The error against the nodes.
struct ExactObjective {
    using Job = FitJob;
    using Result = Norm;
    using Scaling = LobeScaling;
    static constexpr int kMostUnknowns = 5;
    LaneJobs<FitJob> jobs;
    Norm result{}; // of the last evaluation

    void take(int lane, const FitJob& job) { jobs.take(lane, job); }
    void drop(int lane) { jobs.drop(lane); }
    LUMEL_INLINE Sums sum(const Lobe& lobe) const
    {
        Sums all{};
        for (int lane = 0; lane < W; ++lane)
            if (jobs.of[lane])
                reduce(sumNodes(jobs.of[lane]->nodes, broadcast(lobe, lane)), lane, all);
        return all;
    }
    LUMEL_INLINE V operator()(const LobeScaling& scaling, const V* x, V* gradient)
    {
        const Lobe lobe = scaling.lobe(x);
        const Sums sum = this->sum(lobe);
        const Overlap o = overlapOf(lobe, sum, jobs.busy);
        const V explained = o.gf * o.gf / (scaling.energy * o.ff);
        result.norm = o.ff;
        gradientOf(lobe, slopesOf(lobe, sum, o), explained, gradient);
        scaling.scale(gradient);
        // N beyond the disc: the step was too long, regardless of its sum.
        return lobe.outside ? splat(4.0f) : 1.0f - explained;
    }
};
