// The error of two lobes F = K1 f1 + K2 f2, by variable projection (Golub and Pereyra 1973): for given shapes,
// both K solve a linear least-squares problem with K >= 0, and by the envelope theorem the slopes are those
// with K held:
//     E / <G,G> = 1 - (2 K.g - K.A K) / <G,G>,   g_i = <G, f_i>,   A_ij = <f_i, f_j>,
//     dE / <G,G> = -(2 K_i dg_i - K_i^2 dA_ii - 2 K1 K2 dA_12) / <G,G>   for the unknowns of f_i.

// What a search for two lobes keeps beside its error.
struct PairResult {
    V ks[2]{}, norm[2]{}, cross{};
    V share[2]{}; // K_i^2 A_ii / <G, G>

    LUMEL_INLINE void take(I where, const PairResult& other)
    {
        cross = where ? other.cross : cross;
        for (int i = 0; i < 2; ++i) {
            ks[i] = where ? other.ks[i] : ks[i];
            norm[i] = where ? other.norm[i] : norm[i];
            share[i] = where ? other.share[i] : share[i];
        }
    }
    void finish(int lane, PairJob& job) const
    {
        job.cross = cross[lane];
        for (int i = 0; i < 2; ++i) {
            job.ks[i] = ks[i][lane];
            job.norm[i] = norm[i][lane];
        }
    }
};

struct PairScaling {
    LobeScaling lobes[2];
    V energy;

    int ofLobe() const { return lobes[0].isotropic ? 3 : 5; }
    void idle(bool tied)
    {
        energy = splat(1.0f);
        lobes[0].idle(tied);
        lobes[1].idle(tied);
    }
    void start(int lane, const PairJob& job, V* x)
    {
        energy[lane] = job.energy;
        for (int i = 0; i < 2; ++i)
            lobes[i].startAt(lane, job.unknowns[i], job.maxLog, x + i * ofLobe());
    }
    void finish(int lane, const V* x, PairJob& job) const
    {
        for (int i = 0; i < 2; ++i)
            lobes[i].finishAt(lane, x + i * ofLobe(), job.unknowns[i]);
    }
    LUMEL_INLINE void bound(V* x) const
    {
        lobes[0].bound(x);
        lobes[1].bound(x + ofLobe());
    }
    // The error curves with what the lobe explains.
    LUMEL_INLINE V flatness(int i, const PairResult& result) const
    {
        return 1.0f / maximum(minimum(result.share[i], splat(1.0f)), splat(0.05f));
    }
    LUMEL_INLINE void scale(V* gradient) const
    {
        V own[2][5];
        for (int i = 0; i < 2; ++i) {
            for (int j = 0; j < 5; ++j)
                own[i][j] = gradient[5 * i + j];
            lobes[i].scale(own[i]);
        }
        for (int i = 0; i < 2; ++i)
            for (int j = 0; j < ofLobe(); ++j)
                gradient[i * ofLobe() + j] = own[i][j];
    }
};

// Both K from g and A, and the error; where A is near singular or a K would be below 0, the better lobe alone.
LUMEL_INLINE V project(const V* g, const V* norm, V cross, V energy, PairResult& result)
{
    const V product = norm[0] * norm[1], det = product - cross * cross;
    const V inverse = 1.0f / maximum(det, 1e-4f * product);
    const V k1 = (g[0] * norm[1] - g[1] * cross) * inverse, k2 = (g[1] * norm[0] - g[0] * cross) * inverse;
    const V alone1 = g[0] / norm[0], alone2 = g[1] / norm[1];
    const I single = (k1 <= 0.0f) | (k2 <= 0.0f) | (det <= 1e-4f * product);
    const I first = g[0] * alone1 >= g[1] * alone2;
    result.ks[0] = single ? (first ? alone1 : V{}) : k1;
    result.ks[1] = single ? (first ? V{} : alone2) : k2;
    result.cross = cross;
    V explained = -2.0f * result.ks[0] * result.ks[1] * cross;
    for (int i = 0; i < 2; ++i) {
        result.norm[i] = norm[i];
        result.share[i] = result.ks[i] * result.ks[i] * norm[i] / energy;
        explained += result.ks[i] * (2.0f * g[i] - result.ks[i] * norm[i]);
    }
    return 1.0f - explained / energy;
}

// Slopes of <w, f> by its sums over nodes, as in slopesOf().
LUMEL_INLINE LogSlopes overlapSlopes(const Lobe& lobe, const Sums& s)
{
    const V scale = squareRoot(lobe.det), half = 0.5f * s.one / lobe.det;
    return {scale * 2.0f * s.alpha,
            scale * 2.0f * s.beta,
            scale * -2.0f * (lobe.pxy * (s.mbb - s.maa) + (lobe.pxx - lobe.pyy) * s.mab),
            scale * (half * lobe.pyy - s.maa),
            scale * (-half * lobe.pxy - s.mab),
            scale * (half * lobe.pxx - s.mbb)};
}

// d - factor * slopes of <f, f>.
LUMEL_INLINE void subtractNormSlopes(LogSlopes& d, const Lobe& lobe, const Overlap& o, V factor)
{
    const Frame& f = lobe.frame;
    const Sums& rim = o.rim;
    const V scale = factor * o.ff, plus = o.closed * 0.5f / lobe.detPlus, inverseDet = 1.0f / lobe.det;
    d.alpha -= scale * (4.0f * rim.alpha - o.closed * f.nx * f.inverseR);
    d.beta -= scale * (4.0f * rim.beta - o.closed * f.ny * f.inverseR / f.nz);
    d.gamma += scale * 4.0f * (lobe.pxy * (rim.mbb - rim.maa) + (lobe.pxx - lobe.pyy) * rim.mab);
    d.pxx -= scale * (lobe.pyy * inverseDet - (lobe.pyy + 1.0f) * plus - 2.0f * rim.maa);
    d.pxy -= scale * (-lobe.pxy * inverseDet + lobe.pxy * plus - 2.0f * rim.mab);
    d.pyy -= scale * (lobe.pxx * inverseDet - (lobe.pxx + 1.0f) * plus - 2.0f * rim.mbb);
}

// factor * sum + otherFactor * other.
LUMEL_INLINE Sums combined(const Sums& sum, V factor, const Sums& other, V otherFactor)
{
    return {factor * sum.one + otherFactor * other.one,   factor * sum.alpha + otherFactor * other.alpha,
            factor * sum.beta + otherFactor * other.beta, factor * sum.maa + otherFactor * other.maa,
            factor * sum.mab + otherFactor * other.mab,   factor * sum.mbb + otherFactor * other.mbb};
}

// Two lobes against the nodes; <f1, f2> is a sum over them too.
struct PairObjective {
    using Job = PairJob;
    using Result = PairResult;
    using Scaling = PairScaling;
    static constexpr int kMostUnknowns = 10;
    LaneJobs<PairJob> jobs;
    PairResult result{}; // of the last evaluation

    void take(int lane, const PairJob& job) { jobs.take(lane, job); }
    void drop(int lane) { jobs.drop(lane); }
    // Sums of area * G * f_i, and of area * f1 * f2 as f_i weighs them.
    LUMEL_INLINE void sum(const Lobe* lobes, Sums* average, Sums* cross) const
    {
        for (int lane = 0; lane < W; ++lane) {
            const PairJob* job = jobs.of[lane];
            if (!job)
                continue;
            const NodeList& nodes = job->nodes;
            const Lobe own1 = broadcast(lobes[0], lane), own2 = broadcast(lobes[1], lane);
            Sums average1{}, average2{}, cross1{}, cross2{};
            for (int k = 0; k < nodes.count; k += W) {
                const V x = load(nodes.x + k), y = load(nodes.y + k), z = load(nodes.z + k);
                const V weight = load(nodes.weight + k);
                const PointTerms p1 = termsAt(locate(own1.frame, x, y, z), own1, 1.0f);
                const PointTerms p2 = termsAt(locate(own2.frame, x, y, z), own2, 1.0f);
                const V both = load(job->area + k) * p1.f * p2.f;
                accumulate(average1, p1, weight);
                accumulate(average2, p2, weight);
                cross1.one += both;
                accumulateSlopes(cross1, p1, both);
                accumulateSlopes(cross2, p2, both);
            }
            cross2.one = cross1.one;
            reduce(average1, lane, average[0]);
            reduce(average2, lane, average[1]);
            reduce(cross1, lane, cross[0]);
            reduce(cross2, lane, cross[1]);
        }
    }
    LUMEL_INLINE V operator()(const PairScaling& scaling, const V* x, V* gradient)
    {
        const Lobe lobes[2] = {scaling.lobes[0].lobe(x), scaling.lobes[1].lobe(x + scaling.ofLobe())};
        Sums average[2]{}, cross[2]{};
        sum(lobes, average, cross);
        const Overlap o[2] = {overlapOf(lobes[0], average[0], jobs.busy),
                              overlapOf(lobes[1], average[1], jobs.busy)};
        const V g[2] = {o[0].gf, o[1].gf}, norm[2] = {o[0].ff, o[1].ff};
        const V between = squareRoot(lobes[0].det) * squareRoot(lobes[1].det) * cross[0].one;
        const V error = project(g, norm, between, scaling.energy, result);
        const V inverse = 1.0f / scaling.energy, both = result.ks[0] * result.ks[1];
        for (int i = 0; i < 2; ++i) {
            const Sums s = combined(average[i], 2.0f * result.ks[i], cross[i],
                                    -2.0f * both * squareRoot(lobes[1 - i].det));
            LogSlopes d = overlapSlopes(lobes[i], s);
            subtractNormSlopes(d, lobes[i], o[i], result.ks[i] * result.ks[i]);
            gradientOf(lobes[i], d, inverse, gradient + 5 * i);
        }
        scaling.scale(gradient);
        return (lobes[0].outside | lobes[1].outside) ? splat(4.0f) : error;
    }
};

// A lobe of a mixture's search: S = (P + I)^-1, and f is scaled to 1 / sqrt(det S) at its peak.
struct MixtureLobe {
    Lobe lobe;
    V sxx, sxy, syy, plus; // plus = 1 / sqrt(det S)

    LUMEL_INLINE explicit MixtureLobe(const Lobe& of) : lobe(of)
    {
        const V inverseDet = 1.0f / lobe.detPlus;
        sxx = (lobe.pyy + 1.0f) * inverseDet;
        sxy = -lobe.pxy * inverseDet;
        syy = (lobe.pxx + 1.0f) * inverseDet;
        plus = squareRoot(lobe.detPlus);
    }
    // What F of Ks 1 is of that.
    LUMEL_INLINE V amplitude() const { return squareRoot(lobe.det) / plus; }
    LUMEL_INLINE Component component() const
    {
        const Frame& f = lobe.frame;
        return {f.nx, f.ny, f.nz, sxx, sxy, syy, splat(1.0f)};
    }
};

// Slopes of 2 K_i <G, f_i> - 2 K1 K2 <f1, f2> by its sums, and of -K_i^2 <f_i, f_i>; all over 2 pi.
LUMEL_INLINE LogSlopes mixtureSlopes(const MixtureLobe& m, const MixtureSums& s, V ks)
{
    const Frame& f = m.lobe.frame;
    // <f, f> / 2 pi = N.z plus / 2.
    const V square = 0.5f * ks * ks * m.plus;
    const V height = (square - s.height) * f.inverseR;
    const V ax = m.sxx * s.txx + m.sxy * s.txy, ay = m.sxx * s.txy + m.sxy * s.tyy;
    const V bx = m.sxy * s.txx + m.syy * s.txy, by = m.sxy * s.txy + m.syy * s.tyy;
    const V grow = square * f.nz;
    return {s.alpha + height * f.nx * f.nz,
            s.beta + height * f.ny,
            s.gamma,
            -0.5f * (ax * m.sxx + ay * m.sxy + grow * m.sxx),
            -0.5f * (ax * m.sxy + ay * m.syy + grow * m.sxy),
            -0.5f * (bx * m.sxy + by * m.syy + grow * m.syy)};
}

LUMEL_INLINE MixtureSums combined(const MixtureSums& a, V factorA, const MixtureSums& b, V factorB)
{
    return {factorA * a.overlap + factorB * b.overlap, factorA * a.alpha + factorB * b.alpha,
            factorA * a.beta + factorB * b.beta,       factorA * a.gamma + factorB * b.gamma,
            factorA * a.txx + factorB * b.txx,         factorA * a.txy + factorB * b.txy,
            factorA * a.tyy + factorB * b.tyy,         factorA * a.height + factorB * b.height};
}

// Two lobes against a mixture.
struct PairMixtureObjective {
    using Job = PairJob;
    using Result = PairResult;
    using Scaling = PairScaling;
    static constexpr int kMostUnknowns = 10;
    LaneTerms terms;
    PairResult result{}; // of the last evaluation

    explicit PairMixtureObjective(float* scratch) : terms{scratch} {}
    void take(int lane, const PairJob& job) { terms.take(lane, job.mixture, job.mixtureCount); }
    void drop(int lane) { terms.drop(lane); }

    LUMEL_INLINE V operator()(const PairScaling& scaling, const V* x, V* gradient)
    {
        constexpr float kPi = 3.14159265f, kTwoPi = 6.28318531f;
        const MixtureLobe lobes[2] = {MixtureLobe(scaling.lobes[0].lobe(x)),
                                      MixtureLobe(scaling.lobes[1].lobe(x + scaling.ofLobe()))};
        MixtureSums average[2], cross[2]{};
        V g[2], norm[2];
        for (int i = 0; i < 2; ++i) {
            const MixtureLobe &m = lobes[i], &other = lobes[1 - i];
            average[i] = sumMixture(terms, m.lobe, m.sxx, m.sxy, m.syy);
            accumulate(cross[i], productOf(other.component(), m.lobe.frame, m.sxx, m.sxy, m.syy));
            g[i] = kTwoPi * average[i].overlap;
            norm[i] = kPi * m.lobe.frame.nz * m.plus;
        }
        const V between = kPi * (cross[0].overlap + cross[1].overlap);
        const V error = project(g, norm, between, scaling.energy, result);
        const V inverse = kTwoPi / scaling.energy, both = result.ks[0] * result.ks[1];
        for (int i = 0; i < 2; ++i) {
            const MixtureSums sums = combined(average[i], 2.0f * result.ks[i], cross[i], -2.0f * both);
            gradientOf(lobes[i].lobe, mixtureSlopes(lobes[i], sums, result.ks[i]), inverse, gradient + 5 * i);
        }
        scaling.scale(gradient);
        unscale(lobes);
        return (lobes[0].lobe.outside | lobes[1].lobe.outside) ? splat(4.0f) : error;
    }
    // From scaled shapes to those of Ks 1.
    LUMEL_INLINE void unscale(const MixtureLobe* lobes)
    {
        const V amplitude[2] = {lobes[0].amplitude(), lobes[1].amplitude()};
        for (int i = 0; i < 2; ++i) {
            result.ks[i] = result.ks[i] / amplitude[i];
            result.norm[i] *= amplitude[i] * amplitude[i];
        }
        result.cross *= amplitude[0] * amplitude[1];
    }
};
