// The error against a mixture of Gaussians: G as a few lobes, or as stand-ins for many, whose overlap with
// another lobe has a closed form. The weight h.z of the disc is shared by both factors of a product: sqrt(h.z)
// times a lobe is about a Gaussian of precision P + I, exactly so in energy and in overlap of concentric
// isotropic lobes. With S = (P + I)^-1, and component i seen from the lobe's frame at e_i,
//     <F_i, f> = 2 pi A_i sqrt(N.z det P / det(P + I)) exp(-e_i^T T^-1 e_i / 2) / sqrt(det T),  T = S_i + S,
//     <f, f> = N.z pi det P / sqrt(det(P + I)),   A_i = share * Ks sqrt(N_i.z det P_i / det(P_i + I)).
// Lobes (N.h)^p at the angle t overlap by cos(t / 2)^(2 p), not exp(-p sin^2(t) / 4), hence e_i is stretched by
// 1 + kStretch (1 - cos t), which matches the two to the fourth order.
constexpr float kStretch = 0.375f;

struct MixtureSums {
    V overlap, alpha, beta, gamma, txx, txy, tyy; // dC by tilt, twist and entries of T
};

// Components as they are stored: rows of x, y, z, S.xx, S.xy, S.yy, A.
struct Component {
    V x, y, z, sxx, sxy, syy, amplitude;
};

// What one component adds to <G, f>, and T^-1 e.
struct Product {
    V a, b, c, stretch, ma, mb, txx, txy, tyy, inverseDet, value;
};

LUMEL_INLINE Product productOf(const Component& i, const Frame& f, V sxx, V sxy, V syy)
{
    Product p;
    p.c = f.nx * i.x + f.ny * i.y + f.nz * i.z;
    p.stretch = 1.0f + kStretch * (1.0f - p.c);
    p.a = (i.x - f.nx * p.c) * f.inverseR;
    p.b = (f.nz * i.y - f.ny * i.z) * f.inverseR;
    p.txx = sxx + i.sxx;
    p.txy = sxy + i.sxy;
    p.tyy = syy + i.syy;
    p.inverseDet = 1.0f / (p.txx * p.tyy - p.txy * p.txy);
    const V scale = p.stretch * p.inverseDet;
    p.ma = (p.tyy * p.a - p.txy * p.b) * scale;
    p.mb = (p.txx * p.b - p.txy * p.a) * scale;
    const V exponent = -0.5f * p.stretch * (p.a * p.ma + p.b * p.mb);
    p.value = p.c > 0.0f ? i.amplitude * squareRoot(p.inverseDet) * exponential(exponent) : V{};
    return p;
}

LUMEL_INLINE MixtureSums sumMixture(const float* row, int count, const Lobe& lobe, V sxx, V sxy, V syy)
{
    MixtureSums sum{};
    for (int i = 0; i < count; ++i, row += 7 * W) {
        const Component component{load(row),         load(row + W),     load(row + 2 * W), load(row + 3 * W),
                                  load(row + 4 * W), load(row + 5 * W), load(row + 6 * W)};
        const Product p = productOf(component, lobe.frame, sxx, sxy, syy);
        const V radial = kStretch * (p.ma * p.a + p.mb * p.b), across = p.stretch * p.c;
        sum.overlap += p.value;
        sum.alpha += p.value * (p.ma * across + radial * p.a);
        sum.beta += p.value * (p.mb * across + radial * p.b);
        sum.gamma += p.value * p.stretch * (p.mb * p.a - p.ma * p.b);
        sum.txx += p.value * (p.ma * p.ma - p.tyy * p.inverseDet);
        sum.txy += p.value * (p.ma * p.mb + p.txy * p.inverseDet);
        sum.tyy += p.value * (p.mb * p.mb - p.txx * p.inverseDet);
    }
    return sum;
}

struct MixtureObjective {
    static constexpr int kRow = 7;
    const float* rows; // [count][kRow][lanes]
    int count = 0;
    V norm{}; // <f, f> of the last evaluation

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
        constexpr float kPi = 3.14159265f;
        const Lobe lobe = scaling.lobe(x);
        const V inverseDet = 1.0f / lobe.detPlus;
        const V sxx = (lobe.pyy + 1.0f) * inverseDet, sxy = -lobe.pxy * inverseDet,
                syy = (lobe.pxx + 1.0f) * inverseDet;
        const MixtureSums sum = sumMixture(rows, count, lobe, sxx, sxy, syy);
        const V inverse = 2.0f / maximum(sum.overlap, splat(1e-30f));
        LogSlopes d;
        d.alpha = sum.alpha * inverse;
        d.beta = sum.beta * inverse;
        d.gamma = sum.gamma * inverse;
        // dC/dT = (sums) / 2; T moves with S = (P + I)^-1: d/dP = -S (d/dT) S, and ln det(P + I) / 2 gives S / 2.
        const V half = 0.5f * inverse;
        const V ax = sxx * sum.txx + sxy * sum.txy, ay = sxx * sum.txy + sxy * sum.tyy;
        const V bx = sxy * sum.txx + syy * sum.txy, by = sxy * sum.txy + syy * sum.tyy;
        d.pxx = -half * (ax * sxx + ay * sxy) - 0.5f * sxx;
        d.pxy = -half * (ax * sxy + ay * syy) - 0.5f * sxy;
        d.pyy = -half * (bx * sxy + by * syy) - 0.5f * syy;
        const V plus = squareRoot(lobe.detPlus);
        const V explained = 4.0f * kPi * sum.overlap * sum.overlap / (scaling.energy * plus);
        norm = kPi * lobe.frame.nz * lobe.det / plus;
        gradientOf(lobe, d, explained, gradient);
        scaling.scale(gradient);
        return lobe.outside ? splat(4.0f) : 1.0f - explained;
    }
};

// <G, G>: every pair of components, a vector of second ones at a time.
float mixtureEnergy(const MixtureTerm* terms, int count)
{
    constexpr float kPi = 3.14159265f;
    constexpr int kMost = 128; // second components at once
    float rows[7][kMost];
    V total{};
    for (int first = 0; first < count; first += kMost) {
        const int n = count - first < kMost ? count - first : kMost, whole = (n + W - 1) / W * W;
        for (int k = 0; k < whole; ++k) {
            const MixtureTerm& m = terms[first + (k < n ? k : 0)];
            const float values[7] = {m.nx, m.ny, m.nz, m.sxx, m.sxy, m.syy, k < n ? m.amplitude : 0.0f};
            for (int j = 0; j < 7; ++j)
                rows[j][k] = values[j];
        }
        for (int i = 0; i < count; ++i) {
            const MixtureTerm& m = terms[i];
            Frame frame = makeFrame(splat(m.nx), splat(m.ny));
            frame.nz = splat(m.nz);
            V sum{};
            for (int k = 0; k < whole; k += W) {
                const Component c{load(rows[0] + k), load(rows[1] + k), load(rows[2] + k), load(rows[3] + k),
                                  load(rows[4] + k), load(rows[5] + k), load(rows[6] + k)};
                sum += productOf(c, frame, splat(m.sxx), splat(m.sxy), splat(m.syy)).value;
            }
            total += m.amplitude * sum;
        }
    }
    float sum = 0.0f;
    for (int lane = 0; lane < W; ++lane)
        sum += total[lane];
    return 2.0f * kPi * sum;
}
