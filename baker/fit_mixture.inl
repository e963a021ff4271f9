// The error against a mixture: G as a few lobes, or as stand-ins for many, whose overlap with another lobe has a
// closed form. With S = (P + I)^-1, component i seen from the lobe's frame at e_i under the angle t, and
// w = P / (P_i + P) the lobe's weight where both matter, r = w (1 - w), q = 1 - r,
//     <F_i, f> = 2 pi A_i A z exp(-d_i^T T^-1 d_i / 2 + q (1 - cos t)) / sqrt(det T),   T = S_i + S,
//     A_i = share * Ks sqrt(det P_i / det(P_i + I)),  z = (1 - w) N_i.z + w N.z,  d_i = e_i (1 + q (1 - cos t) / 2),
//     <f, f> = N.z pi det P / sqrt(det(P + I)).
// The product of two Gaussians, and what Laplace's method adds for lobes (N.h)^p: concentric lobes overlap exactly,
// lobes apart to 1e-3 as long as they are narrower than their distance to the horizon.
struct MixtureSums {
    V overlap, alpha, beta, gamma, txx, txy, tyy; // dC by tilt, twist and entries of T
    V height;                                     // and by N.z
};

struct Component {
    V x, y, z, sxx, sxy, syy, amplitude;
};

LUMEL_INLINE Component componentAt(const float* row, int stride)
{
    return {load(row),
            load(row + stride),
            load(row + 2 * stride),
            load(row + 3 * stride),
            load(row + 4 * stride),
            load(row + 5 * stride),
            load(row + 6 * stride)};
}

// What one component adds to <G, f>, and T^-1 d.
struct Product {
    V a, b, c, q, stretch, weight, z, ma, mb, txx, txy, tyy, inverseDet, value;
};

LUMEL_INLINE Product productOf(const Component& i, const Frame& f, V sxx, V sxy, V syy)
{
    Product p;
    p.c = f.nx * i.x + f.ny * i.y + f.nz * i.z;
    p.a = (i.x - f.nx * p.c) * f.inverseR;
    p.b = (f.nz * i.y - f.ny * i.z) * f.inverseR;
    p.txx = sxx + i.sxx;
    p.txy = sxy + i.sxy;
    p.tyy = syy + i.syy;
    p.weight = (i.sxx + i.syy) / (p.txx + p.tyy);
    p.z = i.z + p.weight * (f.nz - i.z);
    p.q = 1.0f - p.weight * (1.0f - p.weight);
    const V lift = p.q * (1.0f - p.c);
    p.stretch = 1.0f + 0.5f * lift;
    p.inverseDet = 1.0f / (p.txx * p.tyy - p.txy * p.txy);
    const V scale = p.stretch * p.inverseDet;
    p.ma = (p.tyy * p.a - p.txy * p.b) * scale;
    p.mb = (p.txx * p.b - p.txy * p.a) * scale;
    const V exponent = lift - 0.5f * p.stretch * (p.a * p.ma + p.b * p.mb);
    const V value = i.amplitude * p.z * squareRoot(p.inverseDet) * exponential(exponent);
    p.value = p.c > 0.0f ? value : V{};
    return p;
}

// The weight is taken as fixed in the slopes.
LUMEL_INLINE void accumulate(MixtureSums& sum, const Product& p)
{
    const V radial = p.q * (0.5f * (p.ma * p.a + p.mb * p.b) - 1.0f), across = p.stretch * p.c;
    sum.overlap += p.value;
    sum.alpha += p.value * (p.ma * across + radial * p.a);
    sum.beta += p.value * (p.mb * across + radial * p.b);
    sum.gamma += p.value * p.stretch * (p.mb * p.a - p.ma * p.b);
    sum.txx += p.value * (p.ma * p.ma - p.tyy * p.inverseDet);
    sum.txy += p.value * (p.ma * p.mb + p.txy * p.inverseDet);
    sum.tyy += p.value * (p.mb * p.mb - p.txx * p.inverseDet);
    sum.height += p.value * p.weight / maximum(p.z, splat(1e-3f));
}

// The lanes' mixtures side by side: component i of all lanes in row i.
struct LaneTerms {
    static constexpr int kRow = 7;
    float* rows;    // [components][kRow][lanes]
    int filled = 0; // rows that hold anything
    int count = 0;  // of the longest mixture
    int sizes[W] = {}, last[W] = {};

    void take(int lane, const MixtureTerm* terms, int size)
    {
        // Rows beyond the other lanes' mixtures start empty; beyond this one the lane is cleared.
        for (; filled < size; ++filled)
            for (int i = 0; i < kRow * W; ++i)
                rows[filled * kRow * W + i] = 0.0f;
        for (int i = 0; i < size; ++i) {
            const MixtureTerm& m = terms[i];
            const float values[] = {m.nx, m.ny, m.nz, m.sxx, m.sxy, m.syy, m.amplitude};
            for (int j = 0; j < kRow; ++j)
                rows[(i * kRow + j) * W + lane] = values[j];
        }
        for (int i = size; i < last[lane]; ++i)
            rows[(i * kRow + kRow - 1) * W + lane] = 0.0f; // no amplitude
        last[lane] = size;
        resize(lane, size);
    }
    void drop(int lane) { resize(lane, 0); }
    void resize(int lane, int size)
    {
        sizes[lane] = size;
        count = 0;
        for (const int other : sizes)
            count = count > other ? count : other;
    }
};

LUMEL_INLINE MixtureSums sumMixture(const LaneTerms& terms, const Lobe& lobe, V sxx, V sxy, V syy)
{
    MixtureSums sum{};
    const float* row = terms.rows;
    for (int i = 0; i < terms.count; ++i, row += LaneTerms::kRow * W)
        accumulate(sum, productOf(componentAt(row, W), lobe.frame, sxx, sxy, syy));
    return sum;
}

struct MixtureObjective {
    using Job = FitJob;
    using Result = Norm;
    using Scaling = LobeScaling;
    static constexpr int kMostUnknowns = 5;
    LaneTerms terms;
    Norm result{}; // of the last evaluation

    explicit MixtureObjective(float* scratch) : terms{scratch} {}
    void take(int lane, const FitJob& job) { terms.take(lane, job.mixture, job.mixtureCount); }
    void drop(int lane) { terms.drop(lane); }
    LUMEL_INLINE V operator()(const LobeScaling& scaling, const V* x, V* gradient)
    {
        constexpr float kPi = 3.14159265f;
        const Lobe lobe = scaling.lobe(x);
        const V inverseDet = 1.0f / lobe.detPlus;
        const V sxx = (lobe.pyy + 1.0f) * inverseDet, sxy = -lobe.pxy * inverseDet,
                syy = (lobe.pxx + 1.0f) * inverseDet;
        const MixtureSums sum = sumMixture(terms, lobe, sxx, sxy, syy);
        const V inverse = 2.0f / maximum(sum.overlap, splat(1e-30f));
        LogSlopes d;
        // d N.z = -N.x N.z / r alpha - N.y / r beta; ln<f, f> goes with ln N.z.
        const Frame& f = lobe.frame;
        const V height = (1.0f / f.nz - sum.height * inverse) * f.inverseR;
        d.alpha = sum.alpha * inverse + height * f.nx * f.nz;
        d.beta = sum.beta * inverse + height * f.ny;
        d.gamma = sum.gamma * inverse;
        // dC/dT = (sums) / 2; T moves with S = (P + I)^-1: d/dP = -S (d/dT) S, and ln det(P + I) / 2 gives S / 2.
        const V half = 0.5f * inverse;
        const V ax = sxx * sum.txx + sxy * sum.txy, ay = sxx * sum.txy + sxy * sum.tyy;
        const V bx = sxy * sum.txx + syy * sum.txy, by = sxy * sum.txy + syy * sum.tyy;
        d.pxx = -half * (ax * sxx + ay * sxy) - 0.5f * sxx;
        d.pxy = -half * (ax * sxy + ay * syy) - 0.5f * sxy;
        d.pyy = -half * (bx * sxy + by * syy) - 0.5f * syy;
        const V plus = squareRoot(lobe.detPlus);
        const V explained = 4.0f * kPi * sum.overlap * sum.overlap / (scaling.energy * f.nz * plus);
        result.norm = kPi * f.nz * lobe.det / plus;
        gradientOf(lobe, d, explained, gradient);
        scaling.scale(gradient);
        return lobe.outside ? splat(4.0f) : 1.0f - explained;
    }
};

// Components side by side.
constexpr int kMostColumns = 256;
struct Columns {
    float rows[7][kMostColumns];
    int count = 0; // whole vectors; what pads them adds nothing

    Columns(const MixtureTerm* terms, int n) : count((n + W - 1) / W * W)
    {
        for (int k = 0; k < count; ++k) {
            const MixtureTerm& m = terms[k < n ? k : 0];
            const float values[7] = {m.nx, m.ny, m.nz, m.sxx, m.sxy, m.syy, k < n ? m.amplitude : 0.0f};
            for (int j = 0; j < 7; ++j)
                rows[j][k] = values[j];
        }
    }
    LUMEL_INLINE V overlaps(int k, const Frame& frame, const MixtureTerm& m) const
    {
        const Component c = componentAt(rows[0] + k, kMostColumns);
        return m.amplitude * productOf(c, frame, splat(m.sxx), splat(m.sxy), splat(m.syy)).value;
    }
};

LUMEL_INLINE Frame frameOf(const MixtureTerm& m)
{
    Frame frame = makeFrame(splat(m.nx), splat(m.ny));
    frame.nz = splat(m.nz);
    return frame;
}

constexpr float kTwoPi = 6.28318531f;

float mixtureEnergy(const MixtureTerm* terms, int count)
{
    const FlushToZero flush;
    V total{};
    for (int first = 0; first < count; first += kMostColumns) {
        const int rest = count - first;
        const Columns columns(terms + first, rest < kMostColumns ? rest : kMostColumns);
        for (int i = 0; i < count; ++i) {
            const Frame frame = frameOf(terms[i]);
            for (int k = 0; k < columns.count; k += W)
                total += columns.overlaps(k, frame, terms[i]);
        }
    }
    float sum = 0.0f;
    for (int lane = 0; lane < W; ++lane)
        sum += total[lane];
    return kTwoPi * sum;
}

void mixtureOverlaps(const MixtureTerm* terms, int count, const MixtureTerm& lobe, float* overlaps)
{
    const FlushToZero flush;
    const Frame frame = frameOf(lobe);
    for (int first = 0; first < count; first += kMostColumns) {
        const int rest = count - first, n = rest < kMostColumns ? rest : kMostColumns;
        const Columns columns(terms + first, n);
        for (int k = 0; k < n; k += W) {
            const V values = kTwoPi * columns.overlaps(k, frame, lobe);
            for (int lane = 0; lane < W && k + lane < n; ++lane)
                overlaps[first + k + lane] = values[lane];
        }
    }
}
