// Error of a lobe F = Ks f against the average G over the unit disc (design, "half-angle
// refactoring"): with Ks* = <G,f>/<f,f> (linear least squares)
//     E / <G,G> = 1 - <G,f>^2 / (<G,G> <f,f>).
// <G,f> is a sum over quadrature nodes. <f,f> needs none: in the lobe's own frame, e = (a, b) with
// s = |e|^2, f^2 = det P exp(-2 q k(s)) = det P (1 - s)^(e^T P e / s), and h.z averages to N.z (the
// tangential part is odd), so with g(phi) = the power along phi
//     <f,f> = N.z det P int dphi int_0^1 (1 - r^2)^g r dr = N.z det P int dphi / (2 (g + 1))
//           = N.z pi det P / sqrt(det(P + I)),
// exact but for the part of the lobe that the rim of the disc cuts off.

// Sums over the nodes [count][x, y, z, weight][lanes] of weight * f times: 1, c k e, c k' q e, k e e^T.
struct Sums {
    V one, ka, kb, qa, qb, maa, mab, mbb;
};

LUMEL_INLINE Sums sumNodes(const float* nodes, int count, const Lobe& lobe)
{
    Sums sum{};
    const V pxy2 = 2.0f * lobe.pxy;
    for (int k = 0; k < count; ++k, nodes += 4 * W) {
        const Point p = locate(lobe.frame, load(nodes), load(nodes + W), load(nodes + 2 * W));
        const V aa = p.a * p.a, ab = p.a * p.b, bb = p.b * p.b;
        const V q = lobe.pxx * aa + pxy2 * ab + lobe.pyy * bb;
        const V weight = p.c > 0.0f ? load(nodes + 3 * W) : V{};
        const V wf = weight * exponential(-q * p.k);
        sum.one += wf;
        {
            const V u1 = 1.0f + p.u;
            const V slope = 0.25f * u1 * u1 * u1 * (p.t + 2.0f * u1 * p.v * areaTangentSlope(p.v));
            const V wfk = wf * p.k;
            const V wfck = wfk * p.c, wfq = wf * q * slope;
            sum.ka += wfck * p.a;
            sum.kb += wfck * p.b;
            sum.qa += wfq * p.a;
            sum.qb += wfq * p.b;
            sum.maa += wfk * aa;
            sum.mab += wfk * ab;
            sum.mbb += wfk * bb;
        }
    }
    return sum;
}

struct Overlap {
    V gf, ff; // <G, f>, <f, f>
};

LUMEL_INLINE Overlap overlapOf(const Lobe& lobe, const Sums& sum)
{
    constexpr float kPi = 3.14159265f;
    return {squareRoot(lobe.det) * sum.one, kPi * lobe.frame.nz * lobe.det / squareRoot(lobe.detPlus)};
}

// In the frame, a tilt moves a half vector by da = -alpha c, db = -beta c, a twist by da = gamma b,
// db = -gamma a; d ln f = -2 k (P e).de - 2 k' q e.de. <f,f> changes with N.z only.
LUMEL_INLINE LogSlopes slopesOf(const Lobe& lobe, const Sums& sum)
{
    const Frame& f = lobe.frame;
    const V inverse = 2.0f / maximum(sum.one, splat(1e-30f)); // 2 / <.>: the square of <G,f>
    LogSlopes d;
    d.alpha = 2.0f * (lobe.pxx * sum.ka + lobe.pxy * sum.kb + sum.qa) * inverse;
    d.beta = 2.0f * (lobe.pxy * sum.ka + lobe.pyy * sum.kb + sum.qb) * inverse;
    d.gamma = -2.0f * (lobe.pxy * (sum.mbb - sum.maa) + (lobe.pxx - lobe.pyy) * sum.mab) * inverse;
    // d ln N.z = (alpha Tu.z + beta Tv.z) / N.z, Tu.z = -N.x N.z / r, Tv.z = -N.y / r.
    d.alpha += f.nx * f.inverseR;
    d.beta += f.ny * f.inverseR / f.nz;
    // ln<G,f>^2 gives P^-1 - 2 M / <.>, ln<f,f> gives P^-1 - (P + I)^-1 / 2.
    const V inversePlus = 0.5f / lobe.detPlus;
    d.pxx = (lobe.pyy + 1.0f) * inversePlus - sum.maa * inverse;
    d.pxy = -lobe.pxy * inversePlus - sum.mab * inverse;
    d.pyy = (lobe.pxx + 1.0f) * inversePlus - sum.mbb * inverse;
    return d;
}

// The error against the nodes.
struct ExactObjective {
    static constexpr int kRow = 4;
    const float* rows; // [count][kRow][lanes]
    int count = 0;

    static int size(const FitJob& job) { return job.nodes.count; }
    static void fill(const FitJob& job, int k, float* to)
    {
        to[0] = job.nodes.x[k];
        to[W] = job.nodes.y[k];
        to[2 * W] = job.nodes.z[k];
        to[3 * W] = job.nodes.weight[k];
    }
    LUMEL_INLINE V operator()(const Scaling& scaling, const V* x, V* gradient) const
    {
        const Lobe lobe = scaling.lobe(x);
        const Sums sum = sumNodes(rows, count, lobe);
        const Overlap o = overlapOf(lobe, sum);
        const V explained = o.gf * o.gf / (scaling.energy * o.ff);
        gradientOf(lobe, slopesOf(lobe, sum), explained, gradient);
        scaling.scale(gradient);
        // N beyond the disc: a step too far, whatever its sum says.
        return lobe.outside ? splat(4.0f) : 1.0f - explained;
    }
};
