// Error of a lobe F = Ks f against the average G over the unit disc (design, "half-angle
// refactoring"): with Ks* = <G,f>/<f,f> (linear least squares)
//     E / <G,G> = 1 - <G,f>^2 / (<G,G> <f,f>).
// <G,f> is a sum over quadrature nodes. <f,f> needs none: in the lobe's own frame, e = (a, b) with
// s = |e|^2, f^2 = det P exp(-2 q k(s)) = det P (1 - s)^(e^T P e / s), and h.z averages to N.z (the
// tangential part is odd), so with g(phi) = the power along phi
//     <f,f> = N.z det P int dphi int_0^1 (1 - r^2)^g r dr = N.z det P int dphi / (2 (g + 1))
//           = N.z pi det P / sqrt(det(P + I)),
// exact but for the part of the lobe that the rim of the disc cuts off (fit_rim.inl).

// Sums over the nodes [count][x, y, z, weight][lanes] of weight * f times: 1, c k e, c k' q e, k e e^T.
struct Sums {
    V one, ka, kb, qa, qb, maa, mab, mbb;
};

// One half vector's share of the sums; `exponent` 1 sums f, 2 sums f^2 / det P.
LUMEL_INLINE void accumulate(Sums& sum, const Point& p, const Lobe& lobe, V weight, float exponent)
{
    const V aa = p.a * p.a, ab = p.a * p.b, bb = p.b * p.b;
    const V q = lobe.pxx * aa + 2.0f * lobe.pxy * ab + lobe.pyy * bb;
    const V wf = (p.c > 0.0f ? weight : V{}) * exponential(-exponent * q * p.k);
    const V u1 = 1.0f + p.u;
    const V slope = 0.25f * u1 * u1 * u1 * (p.t + 2.0f * u1 * p.v * areaTangentSlope(p.v));
    const V wfk = wf * p.k;
    const V wfck = wfk * p.c, wfq = wf * q * slope;
    sum.one += wf;
    sum.ka += wfck * p.a;
    sum.kb += wfck * p.b;
    sum.qa += wfq * p.a;
    sum.qb += wfq * p.b;
    sum.maa += wfk * aa;
    sum.mab += wfk * ab;
    sum.mbb += wfk * bb;
}

LUMEL_INLINE Sums sumNodes(const float* nodes, int count, const Lobe& lobe)
{
    Sums sum{};
    for (int k = 0; k < count; ++k, nodes += 4 * W)
        accumulate(sum, locate(lobe.frame, load(nodes), load(nodes + W), load(nodes + 2 * W)), lobe,
                   load(nodes + 3 * W), 1.0f);
    return sum;
}

#include "fit_rim.inl"

struct Overlap {
    V gf, ff; // <G, f>, <f, f>
    V closed; // the closed form's share of <f, f>
    Sums rim; // and what the rim adds, over <f, f>
};

LUMEL_INLINE Overlap overlapOf(const Lobe& lobe, const Sums& sum)
{
    constexpr float kPi = 3.14159265f;
    const V closed = kPi * lobe.frame.nz * lobe.det / squareRoot(lobe.detPlus);
    Overlap o{squareRoot(lobe.det) * sum.one, closed, splat(1.0f), {}};
    if (rimMatters(lobe)) {
        o.rim = sumRim(lobe);
        o.ff = closed + lobe.det * o.rim.one;
        o.closed = closed / o.ff;
        const V share = lobe.det / o.ff;
        V* const sums[] = {&o.rim.ka, &o.rim.kb, &o.rim.qa, &o.rim.qb, &o.rim.maa, &o.rim.mab, &o.rim.mbb};
        for (V* entry : sums)
            *entry *= share;
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
    const V ka = sum.ka * inverse - 2.0f * rim.ka, kb = sum.kb * inverse - 2.0f * rim.kb;
    const V maa = sum.maa * inverse - 2.0f * rim.maa, mab = sum.mab * inverse - 2.0f * rim.mab;
    const V mbb = sum.mbb * inverse - 2.0f * rim.mbb;
    LogSlopes d;
    d.alpha = 2.0f * (lobe.pxx * ka + lobe.pxy * kb + sum.qa * inverse - 2.0f * rim.qa);
    d.beta = 2.0f * (lobe.pxy * ka + lobe.pyy * kb + sum.qb * inverse - 2.0f * rim.qb);
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

// The error against the nodes.
struct ExactObjective {
    using Job = FitJob;
    using Result = Norm;
    using Scaling = LobeScaling;
    static constexpr int kMostUnknowns = 5;
    static constexpr int kRow = 4;
    const float* rows; // [count][kRow][lanes]
    int count = 0;
    Norm result{}; // of the last evaluation

    static int size(const FitJob& job) { return job.nodes.count; }
    static void fill(const FitJob& job, int k, float* to)
    {
        to[0] = job.nodes.x[k];
        to[W] = job.nodes.y[k];
        to[2 * W] = job.nodes.z[k];
        to[3 * W] = job.nodes.weight[k];
    }
    LUMEL_INLINE V operator()(const LobeScaling& scaling, const V* x, V* gradient)
    {
        const Lobe lobe = scaling.lobe(x);
        const Sums sum = sumNodes(rows, count, lobe);
        const Overlap o = overlapOf(lobe, sum);
        const V explained = o.gf * o.gf / (scaling.energy * o.ff);
        result.norm = o.ff;
        gradientOf(lobe, slopesOf(lobe, sum, o), explained, gradient);
        scaling.scale(gradient);
        // N beyond the disc: the step was too long, regardless of its sum.
        return lobe.outside ? splat(4.0f) : 1.0f - explained;
    }
};
