// A cheap approximation of the error, to choose among minima: G as a handful of Gaussians, whose overlap
// with a Gaussian lobe has a closed form. Seen from the lobe's frame, component i lies at e_i with
// covariance S_i, and
//     <F_i, f> = 2 pi A_i exp(-e_i^T T^-1 e_i / 2) / sqrt(det T),   T = S_i + S,
//     <f, f> = N.z pi sqrt(det P)
// (product of two normal densities; A_i = share * Ks * h.z). Components are the lobes under the texel,
// or the finer level's fits. Four exponentials instead of a hundred make many starts affordable.
struct MixtureSums {
    V overlap, alpha, beta, gamma, txx, txy, tyy; // dC by tilt, twist and entries of T
};

LUMEL_INLINE MixtureSums sumMixture(const float* row, int count, const Lobe& lobe, V sxx, V sxy, V syy)
{
    MixtureSums sum{};
    const Frame& f = lobe.frame;
    for (int i = 0; i < count; ++i, row += 7 * W) {
        const V hx = load(row), hy = load(row + W), hz = load(row + 2 * W);
        const V c = f.nx * hx + f.ny * hy + f.nz * hz;
        const V a = (hx - f.nx * c) * f.inverseR, b = (f.nz * hy - f.ny * hz) * f.inverseR;
        const V txx = sxx + load(row + 3 * W);
        const V txy = sxy + load(row + 4 * W);
        const V tyy = syy + load(row + 5 * W);
        const V inverseDet = 1.0f / (txx * tyy - txy * txy);
        const V ma = (tyy * a - txy * b) * inverseDet, mb = (txx * b - txy * a) * inverseDet;
        const V value = load(row + 6 * W) * squareRoot(inverseDet) * exponential(-0.5f * (a * ma + b * mb));
        sum.overlap += value;
        sum.alpha += value * ma * c;
        sum.beta += value * mb * c;
        sum.gamma += value * (mb * a - ma * b);
        sum.txx += value * (ma * ma - tyy * inverseDet);
        sum.txy += value * (ma * mb + txy * inverseDet);
        sum.tyy += value * (mb * mb - txx * inverseDet);
    }
    return sum;
}

struct MixtureObjective {
    static constexpr int kRow = 7;
    const float* rows; // [count][kRow][lanes]
    int count = 0;
    V norm{};

    static int size(const FitJob& job) { return job.mixtureCount; }
    static void fill(const FitJob& job, int i, float* to)
    {
        const MixtureTerm& m = job.mixture[i];
        const float values[kRow] = {m.nx, m.ny, m.nz, m.sxx, m.sxy, m.syy, m.amplitude};
        for (int j = 0; j < kRow; ++j)
            to[j * W] = values[j];
    }
    LUMEL_INLINE V operator()(const Scaling& scaling, const V* x, V* gradient)
    {
        const Lobe lobe = scaling.lobe(x);
        const V inverseDet = 1.0f / lobe.det;
        const V sxx = lobe.pyy * inverseDet, sxy = -lobe.pxy * inverseDet, syy = lobe.pxx * inverseDet;
        const MixtureSums sum = sumMixture(rows, count, lobe, sxx, sxy, syy);
        const Frame& f = lobe.frame;
        const V inverse = 2.0f / maximum(sum.overlap, splat(1e-30f));
        LogSlopes d;
        d.alpha = sum.alpha * inverse + f.nx * f.inverseR;
        d.beta = sum.beta * inverse + f.ny * f.inverseR / f.nz;
        d.gamma = sum.gamma * inverse;
        // dC/dT = (sums) / 2; T moves with S = P^-1: d/dP = -S (d/dT) S, and ln<f,f> gives S / 2.
        const V half = 0.5f * inverse;
        const V ax = sxx * sum.txx + sxy * sum.txy, ay = sxx * sum.txy + sxy * sum.tyy;
        const V bx = sxy * sum.txx + syy * sum.txy, by = sxy * sum.txy + syy * sum.tyy;
        d.pxx = -half * (ax * sxx + ay * sxy) - 0.5f * sxx;
        d.pxy = -half * (ax * sxy + ay * syy) - 0.5f * sxy;
        d.pyy = -half * (bx * sxy + by * syy) - 0.5f * syy;
        constexpr float kPi = 3.14159265f;
        const V overlap = 2.0f * kPi * sum.overlap;
        const V explained = overlap * overlap / (scaling.energy * kPi * f.nz * squareRoot(lobe.det));
        gradientOf(lobe, d, explained, gradient);
        scaling.scale(gradient);
        return lobe.outside ? splat(4.0f) : 1.0f - explained;
    }
};
