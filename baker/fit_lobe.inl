// A lobe and half vectors seen from it. See shaders/shared/lobe.h for the formula.

// A unit normal and its frame (shaders/shared/lobe.h): Tu.h = (h.x - N.x c) / r,
// Tv.h = (N.z h.y - N.y h.z) / r, c = N.h, r = sqrt(1 - N.x^2).
struct Frame {
    V nx, ny, nz, r, inverseR;
};
LUMEL_INLINE Frame makeFrame(V nx, V ny)
{
    Frame f;
    f.nx = nx;
    f.ny = ny;
    f.nz = squareRoot(maximum(1.0f - nx * nx - ny * ny, splat(1e-4f)));
    f.r = squareRoot(maximum(1.0f - nx * nx, splat(1e-4f)));
    f.inverseR = 1.0f / f.r;
    return f;
}

// The falloff k(s) = -log(1 - s) / (2 s) without logarithm or cancellation: with c = N.h = cos theta
// and u = tan^2(theta / 2) = s / (1 + c)^2, log c = -2 atanh u and s = 4 u / (1 + u)^2, so
//     k = (1 + u)^2 T(u^2) / 2,    c dk/ds = (1 + u)^3 (T + 2 (1 + u) u^2 T'(u^2)) / 4.
struct Point {
    V a, b, c, s, u, v, t, k;
};
LUMEL_INLINE Point locate(const Frame& f, V hx, V hy, V hz)
{
    Point p;
    p.c = f.nx * hx + f.ny * hy + f.nz * hz;
    p.a = (hx - f.nx * p.c) * f.inverseR;
    p.b = (f.nz * hy - f.ny * hz) * f.inverseR;
    p.s = p.a * p.a + p.b * p.b;
    const V inverse = 1.0f / (1.0f + maximum(p.c, splat(0.0f)));
    p.u = p.s * inverse * inverse;
    p.v = minimum(p.u * p.u, splat(1.0f));
    p.t = areaTangent(p.v);
    p.k = 0.5f * (1.0f + p.u) * (1.0f + p.u) * p.t;
    return p;
}

// A lobe during the fit, from its unknowns.
struct Lobe {
    Frame frame;
    V e1, e2, l3, pxx, pxy, pyy, det, detPlus; // detPlus = det(P + I)
    I outside;                                 // N beyond the disc
    I atTop[3], atBottom[3];                   // l1, l2, l3 at a bound
};

LUMEL_INLINE Lobe makeLobe(V maxLog, V nx, V ny, V l1, V l2, V l3)
{
    constexpr float kRim = 0.99991f; // a little beyond lobeNormal()'s
    Lobe lobe;
    const V r2 = nx * nx + ny * ny;
    lobe.outside = r2 > kRim;
    const V scale = lobe.outside ? squareRoot(kRim / r2) : splat(1.0f);
    lobe.frame = makeFrame(nx * scale, ny * scale);
    lobe.e1 = exponential(minimum(maximum(l1, splat(kLowestLog)), maxLog));
    lobe.e2 = exponential(minimum(maximum(l2, splat(kLowestLog)), maxLog));
    for (int i = 0; i < 3; ++i) {
        const V l = i == 0 ? l1 : i == 1 ? l2 : l3;
        const V top = i == 2 ? exponential(maxLog) / lobe.e2 : maxLog;
        lobe.atTop[i] = l >= top;
        lobe.atBottom[i] = l <= (i == 2 ? -top : splat(kLowestLog));
    }
    // |shear| <= e^maxLog too: otherwise a long lobe at an angle could get narrower than any lobe under the texel.
    const V largest = exponential(maxLog) / lobe.e2;
    lobe.l3 = minimum(maximum(l3, -largest), largest);
    const V shear = lobe.l3 * lobe.e2;
    lobe.pxx = kBase + lobe.e1 * lobe.e1;
    lobe.pxy = lobe.e1 * shear;
    lobe.pyy = kBase + lobe.e2 * lobe.e2 + shear * shear;
    // det(c I + U^T U) = c^2 + c |U|^2 + det(U)^2, free of cancellation.
    const V trace = lobe.e1 * lobe.e1 + lobe.e2 * lobe.e2 + shear * shear;
    const V detU = lobe.e1 * lobe.e2;
    lobe.det = kBase * kBase + kBase * trace + detU * detU;
    lobe.detPlus = (kBase + 1.0f) * (kBase + 1.0f) + (kBase + 1.0f) * trace + detU * detU;
    return lobe;
}

// Derivatives of ln(<G,f>^2 / <f,f>): for tilting the frame by alpha (towards Tu) and beta (towards Tv)
// and twisting it by gamma about N, with P fixed; and for the entries of P.
struct LogSlopes {
    V alpha, beta, gamma, pxx, pxy, pyy;
};

// Gradient of the error 1 - R in (N.x, N.y, l1, l2, l3), where R = `explained`. Moving N by (dx, dy)
// on the disc tilts the frame by alpha = Tu.dN = dx / r and beta = Tv.dN = (N.x N.y dx + r^2 dy) /
// (N.z r), and twists it by gamma = -N.x beta / r.
LUMEL_INLINE void gradientOf(const Lobe& lobe, const LogSlopes& d, V explained, V* gradient)
{
    const Frame& f = lobe.frame;
    const V inverseNz = 1.0f / f.nz;
    const V beta = d.beta - d.gamma * f.nx * f.inverseR;
    const V shear = lobe.l3 * lobe.e2;
    // P = kBase I + U^T U with U = [e1, shear; 0, e2].
    const V g1 = 2.0f * lobe.e1 * (d.pxx * lobe.e1 + d.pxy * shear);
    const V g2 = 2.0f * (d.pxy * lobe.e1 * shear + d.pyy * (lobe.e2 * lobe.e2 + shear * shear));
    const V g3 = 2.0f * lobe.e2 * (d.pxy * lobe.e1 + d.pyy * shear);
    gradient[0] = -explained * (d.alpha * f.inverseR + beta * f.nx * f.ny * f.inverseR * inverseNz);
    gradient[1] = -explained * beta * f.r * inverseNz;
    const V g[3] = {g1, g2, g3};
    for (int i = 0; i < 3; ++i) {
        // At a bound, only the way back in counts.
        const I outward = (lobe.atTop[i] & (g[i] > 0.0f)) | (lobe.atBottom[i] & (g[i] < 0.0f));
        gradient[2 + i] = outward ? V{} : -explained * g[i];
    }
}

// What a search for one lobe keeps beside its error.
struct Norm {
    V norm{}; // <f, f>
    LUMEL_INLINE void take(I where, const Norm& other) { norm = where ? other.norm : norm; }
    void finish(int lane, FitJob& job) const { job.norm = norm[lane]; }
};

// The unknowns of the searches in units of their starts' own extents: N = origin + B (x0, x1), l1, l2,
// l3. The isotropic model ties l1 = l2 and l3 = 0.
struct LobeScaling {
    V originX, originY, b11, b21, b22, maxLog, energy;
    bool isotropic;

    // Idle lanes compute on harmless numbers.
    void idle(bool tied)
    {
        isotropic = tied;
        originX = originY = b21 = V{};
        b11 = b22 = energy = maxLog = splat(1.0f);
    }
    // The start `unknowns`, from which x counts.
    void startAt(int lane, const float* unknowns, float highest, V* x)
    {
        originX[lane] = unknowns[kX];
        originY[lane] = unknowns[kY];
        b11[lane] = unknowns[kB11];
        b21[lane] = unknowns[kB21];
        b22[lane] = unknowns[kB22];
        maxLog[lane] = highest;
        x[0][lane] = x[1][lane] = 0.0f;
        for (int i = 2; i < (isotropic ? 3 : 5); ++i)
            x[i][lane] = unknowns[kL1 + i - 2];
    }
    void finishAt(int lane, const V* x, float* unknowns) const
    {
        unknowns[kX] = originX[lane] + b11[lane] * x[0][lane];
        unknowns[kY] = originY[lane] + b21[lane] * x[0][lane] + b22[lane] * x[1][lane];
        unknowns[kL1] = x[2][lane];
        unknowns[kL2] = isotropic ? x[2][lane] : x[3][lane];
        unknowns[kL3] = isotropic ? 0.0f : x[4][lane];
    }
    void start(int lane, const FitJob& job, V* x)
    {
        energy[lane] = job.energy;
        startAt(lane, job.unknowns, job.maxLog, x);
    }
    void finish(int lane, const V* x, FitJob& job) const { finishAt(lane, x, job.unknowns); }
    // Beyond the bounds of l1 and l2 lies nothing.
    LUMEL_INLINE void bound(V* x) const
    {
        for (int i = 2; i < (isotropic ? 3 : 4); ++i)
            x[i] = minimum(maximum(x[i], splat(kLowestLog)), maxLog);
    }
    template<class Result>
    LUMEL_INLINE V flatness(int, const Result&) const
    {
        return splat(1.0f);
    }

    LUMEL_INLINE Lobe lobe(const V* x) const
    {
        return makeLobe(maxLog, originX + b11 * x[0], originY + b21 * x[0] + b22 * x[1], x[2],
                        isotropic ? x[2] : x[3], isotropic ? V{} : x[4]);
    }
    LUMEL_INLINE void scale(V* gradient) const
    {
        gradient[0] = b11 * gradient[0] + b21 * gradient[1];
        gradient[1] = b22 * gradient[1];
        if (isotropic) {
            gradient[2] += gradient[3];
            gradient[3] = gradient[4] = V{};
        }
    }
};
