// Included by the fit_*.cpp files, which define LUMEL_LANES and LUMEL_KERNELS. Only GCC's and Clang's
// vector extensions, no intrinsics; and no function of any other header is called here, because an
// inline function compiled for AVX-512 could be the one the linker keeps for the whole program.
//
// Error of a lobe F = Ks f against the average G over the unit disc (design, "half-angle
// refactoring"): with Ks* = <G,f>/<f,f> (linear least squares)
//     E / <G,G> = 1 - <G,f>^2 / (<G,G> <f,f>).
// <G,f> is a sum over quadrature nodes. <f,f> needs none: in the lobe's own frame, e = (a, b) with
// s = |e|^2, f^2 = det P exp(-2 q k(s)) = det P (1 - s)^(e^T P e / s), and h.z averages to N.z (the
// tangential part is odd), so with g(phi) = the power along phi
//     <f,f> = N.z det P int dphi int_0^1 (1 - r^2)^g r dr = N.z det P int dphi / (2 (g + 1))
//           = N.z pi det P / sqrt(det(P + I)),
// exact but for the part of the lobe that the rim of the disc cuts off.
#include "fit_kernel.h"

namespace lumel::baker {
namespace {

constexpr int W = LUMEL_LANES;
typedef float V __attribute__((vector_size(4 * LUMEL_LANES)));
typedef int I __attribute__((vector_size(4 * LUMEL_LANES)));

#define LUMEL_INLINE inline __attribute__((always_inline))

LUMEL_INLINE V splat(float v)
{
    return V{} + v;
}
LUMEL_INLINE V load(const float* p)
{
    V v;
    __builtin_memcpy(&v, p, sizeof v);
    return v;
}
LUMEL_INLINE void store(float* p, V v)
{
    __builtin_memcpy(p, &v, sizeof v);
}
LUMEL_INLINE V minimum(V a, V b)
{
    return a < b ? a : b;
}
LUMEL_INLINE V maximum(V a, V b)
{
    return a > b ? a : b;
}
LUMEL_INLINE V magnitude(V a)
{
    return (V)((I)a & 0x7fffffff);
}
LUMEL_INLINE V squareRoot(V a)
{
#if LUMEL_LANES == 1
    return V{__builtin_sqrtf(a[0])};
#else
    V r;
    for (int i = 0; i < W; ++i) // compiles to one instruction
        r[i] = __builtin_sqrtf(a[i]);
    return r;
#endif
}
LUMEL_INLINE bool any(I mask)
{
    int all = 0;
    for (int i = 0; i < W; ++i)
        all |= mask[i];
    return all != 0;
}

// e^x by 2^n times a minimax polynomial of 2^f, |f| <= 1/2; relative error 2e-7 for x in [-80, 80].
LUMEL_INLINE V exponential(V x)
{
    x = minimum(maximum(x, splat(-80.0f)), splat(80.0f));
    const V t = x * 1.44269504f;
    const V shifted = t + 12582912.0f; // 1.5 * 2^23: rounds to an integer kept in the low bits
    const V f = t - (shifted - 12582912.0f);
    V p = splat(1.33908634e-3f);
    p = p * f + 9.67603192e-3f;
    p = p * f + 5.55035671e-2f;
    p = p * f + 2.40221075e-1f;
    p = p * f + 6.93147188e-1f;
    p = p * f + 1.0f;
    return (V)((I)p + ((I)shifted << 23));
}

// T(v) = atanh(sqrt v) / sqrt v by a Chebyshev fit on [0, 1/2] (relative error 7e-7), and its slope.
constexpr float kT[] = {1.0f,         0.333247831f,  0.202671315f, 0.112291695f,
                        0.271921616f, -0.316484862f, 0.513029191f};
LUMEL_INLINE V areaTangent(V v)
{
    V p = splat(kT[6]);
    for (int j = 5; j >= 0; --j)
        p = p * v + kT[j];
    return p;
}
LUMEL_INLINE V areaTangentSlope(V v)
{
    V p = splat(6.0f * kT[6]);
    for (int j = 5; j >= 1; --j)
        p = p * v + float(j) * kT[j];
    return p;
}

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

void averageIsotropic(const LobeBatch& batch, const NodeBlock& nodes, float* g)
{
    for (int k = 0; k < nodes.count; ++k) {
        const V hx = load(nodes.x + k * W), hy = load(nodes.y + k * W), hz = load(nodes.z + k * W);
        V sum = load(g + k * W);
        for (int i = 0; i < batch.count; ++i) {
            // |h - N|^2 / 2 = 1 - N.h without cancellation; log c = -2 atanh((1 - c) / (1 + c)).
            const V dx = hx - load(batch.nx + i * W);
            const V dy = hy - load(batch.ny + i * W);
            const V dz = hz - load(batch.nz + i * W);
            const V t = 0.5f * (dx * dx + dy * dy + dz * dz);
            const V u = t / (2.0f - minimum(t, splat(1.0f)));
            const V logC = -2.0f * u * areaTangent(u * u);
            const V f = exponential(load(batch.pxx + i * W) * logC);
            sum += t < 1.0f ? load(batch.amplitude + i * W) * f : V{};
        }
        store(g + k * W, sum);
    }
}

void averageAnisotropic(const LobeBatch& batch, const NodeBlock& nodes, float* g)
{
    for (int i = 0; i < batch.count; ++i) {
        Frame f = makeFrame(load(batch.nx + i * W), load(batch.ny + i * W));
        f.nz = load(batch.nz + i * W);
        const V pxx = load(batch.pxx + i * W), pxy = load(batch.pxy + i * W), pyy = load(batch.pyy + i * W);
        const V amplitude = load(batch.amplitude + i * W);
        for (int k = 0; k < nodes.count; ++k) {
            const Point p = locate(f, load(nodes.x + k * W), load(nodes.y + k * W), load(nodes.z + k * W));
            const V q = pxx * p.a * p.a + 2.0f * pxy * p.a * p.b + pyy * p.b * p.b;
            const V value = p.c > 0.0f ? amplitude * exponential(-q * p.k) : V{};
            store(g + k * W, load(g + k * W) + value);
        }
    }
}

void average(const LobeBatch& batch, const NodeBlock& nodes, float* g)
{
    if (batch.isotropic)
        averageIsotropic(batch, nodes, g);
    else
        averageAnisotropic(batch, nodes, g);
}

// A lobe during the fit: what its unknowns stand for.
struct Lobe {
    Frame frame;
    V e1, e2, l3, pxx, pxy, pyy, det, detPlus; // detPlus = det(P + I)
    I outside, freeL1, freeL2;                 // masks: N beyond the disc; l1, l2 not at a bound
};

LUMEL_INLINE Lobe makeLobe(const FitProblem& problem, V nx, V ny, V l1, V l2, V l3)
{
    constexpr float kRim = 0.98f, kLowestLog = -3.5f, kLargestShear = 64.0f;
    Lobe lobe;
    const V r2 = nx * nx + ny * ny;
    lobe.outside = r2 > kRim;
    const V scale = lobe.outside ? squareRoot(kRim / r2) : splat(1.0f);
    lobe.frame = makeFrame(nx * scale, ny * scale);
    const V highest = load(problem.maxLog);
    lobe.freeL1 = (l1 > kLowestLog) & (l1 < highest);
    lobe.freeL2 = (l2 > kLowestLog) & (l2 < highest);
    lobe.e1 = exponential(minimum(maximum(l1, splat(kLowestLog)), highest));
    lobe.e2 = exponential(minimum(maximum(l2, splat(kLowestLog)), highest));
    lobe.l3 = minimum(maximum(l3, splat(-kLargestShear)), splat(kLargestShear));
    const V shear = lobe.l3 * lobe.e2;
    lobe.pxx = 1.0f + lobe.e1 * lobe.e1;
    lobe.pxy = lobe.e1 * shear;
    lobe.pyy = 1.0f + lobe.e2 * lobe.e2 + shear * shear;
    // det(I + U^T U) = 1 + |U|^2 + det(U)^2, free of cancellation; the same with 2 I.
    const V trace = lobe.e1 * lobe.e1 + lobe.e2 * lobe.e2 + shear * shear;
    const V detU = lobe.e1 * lobe.e2;
    lobe.det = 1.0f + trace + detU * detU;
    lobe.detPlus = 4.0f + 2.0f * trace + detU * detU;
    return lobe;
}

// Sums over the nodes of weight * f times: 1, c k e, c k' q e, k e e^T.
struct Sums {
    V one, ka, kb, qa, qb, maa, mab, mbb;
};

template<bool kGradient>
LUMEL_INLINE Sums sumNodes(const NodeBlock& nodes, const Lobe& lobe)
{
    Sums sum{};
    const V pxy2 = 2.0f * lobe.pxy;
    for (int k = 0; k < nodes.count; ++k) {
        const Point p =
            locate(lobe.frame, load(nodes.x + k * W), load(nodes.y + k * W), load(nodes.z + k * W));
        const V aa = p.a * p.a, ab = p.a * p.b, bb = p.b * p.b;
        const V q = lobe.pxx * aa + pxy2 * ab + lobe.pyy * bb;
        const V weight = p.c > 0.0f ? load(nodes.weight + k * W) : V{};
        const V wf = weight * exponential(-q * p.k);
        sum.one += wf;
        if (kGradient) {
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

// Gradient of the error in (N.x, N.y, l1, l2, l3). With P fixed, moving N by dN tilts the frame:
// alpha = Tu.dN = dx / r, beta = Tv.dN = (N.x N.y dx + r^2 dy) / (N.z r), and twists it about N by
// gamma = -N.x beta / r, so da = -alpha c + gamma b, db = -beta c - gamma a.
LUMEL_INLINE void gradientOf(const Lobe& lobe, const Sums& sum, V relativeLoss, V* gradient)
{
    const Frame& f = lobe.frame;
    const V inverseSum = 1.0f / maximum(sum.one, splat(1e-30f));
    // d ln<G,f> along alpha and beta; the twist only turns P.
    const V byAlpha = 2.0f * (lobe.pxx * sum.ka + lobe.pxy * sum.kb + sum.qa) * inverseSum;
    V byBeta = 2.0f * (lobe.pxy * sum.ka + lobe.pyy * sum.kb + sum.qb) * inverseSum;
    const V byTwist = -2.0f * (lobe.pxy * (sum.mbb - sum.maa) + (lobe.pxx - lobe.pyy) * sum.mab) * inverseSum;
    byBeta -= byTwist * f.nx * f.inverseR;
    // d ln of <G,f>^2 / <f,f>, whose N.z gives d ln<f,f> = -(N.x dx + N.y dy) / N.z^2.
    const V inverseNz = 1.0f / f.nz;
    const V toNx = f.nx * inverseNz * inverseNz, toNy = f.ny * inverseNz * inverseNz;
    const V gx = 2.0f * (byAlpha * f.inverseR + byBeta * f.nx * f.ny * f.inverseR * inverseNz) + toNx;
    const V gy = 2.0f * byBeta * f.r * inverseNz + toNy;
    // d/dP: ln<G,f> gives P^-1 / 2 - M / <.>, ln<f,f> gives P^-1 - (P + I)^-1 / 2.
    const V inversePlus = 0.5f / lobe.detPlus;
    const V dxx = (lobe.pyy + 1.0f) * inversePlus - 2.0f * sum.maa * inverseSum;
    const V dxy = -lobe.pxy * inversePlus - 2.0f * sum.mab * inverseSum;
    const V dyy = (lobe.pxx + 1.0f) * inversePlus - 2.0f * sum.mbb * inverseSum;
    const V shear = lobe.l3 * lobe.e2;
    const V g1 = 2.0f * lobe.e1 * (dxx * lobe.e1 + dxy * shear);
    const V g2 = 2.0f * (dxy * lobe.e1 * shear + dyy * (lobe.e2 * lobe.e2 + shear * shear));
    const V g3 = 2.0f * lobe.e2 * (dxy * lobe.e1 + dyy * shear);
    // E = 1 - R, dE = -R d ln R.
    gradient[0] = -relativeLoss * gx;
    gradient[1] = -relativeLoss * gy;
    gradient[2] = lobe.freeL1 ? -relativeLoss * g1 : V{};
    gradient[3] = lobe.freeL2 ? -relativeLoss * g2 : V{};
    gradient[4] = -relativeLoss * g3;
}

void evaluate(const FitProblem& problem, const float* x, float* overlap, float* norm, float* gradient)
{
    const Lobe lobe = makeLobe(problem, load(x + kX * W), load(x + kY * W), load(x + kL1 * W),
                               load(x + kL2 * W), load(x + kL3 * W));
    const Sums sum = gradient ? sumNodes<true>(problem.nodes, lobe) : sumNodes<false>(problem.nodes, lobe);
    const Overlap o = overlapOf(lobe, sum);
    store(overlap, o.gf);
    store(norm, o.ff);
    if (gradient) {
        V g[5];
        gradientOf(lobe, sum, o.gf * o.gf / (load(problem.energy) * o.ff), g);
        for (int j = 0; j < 5; ++j)
            store(gradient + j * W, g[j]);
    }
}

// The error and its gradient in the scaled unknowns: N = origin + B (x0, x1), l1, l2, l3.
struct Objective {
    const FitProblem& problem;
    V originX, originY, b11, b21, b22;

    LUMEL_INLINE V operator()(const V* x, V* gradient) const
    {
        const V nx = originX + b11 * x[0];
        const V ny = originY + b21 * x[0] + b22 * x[1];
        const bool iso = problem.isotropic;
        const Lobe lobe = makeLobe(problem, nx, ny, x[2], iso ? x[2] : x[3], iso ? V{} : x[4]);
        const Sums sum = sumNodes<true>(problem.nodes, lobe);
        const Overlap o = overlapOf(lobe, sum);
        const V explained = o.gf * o.gf / (load(problem.energy) * o.ff);
        V g[5];
        gradientOf(lobe, sum, explained, g);
        gradient[0] = b11 * g[0] + b21 * g[1];
        gradient[1] = b22 * g[1];
        gradient[2] = iso ? g[2] + g[3] : g[2];
        gradient[3] = iso ? V{} : g[3];
        gradient[4] = iso ? V{} : g[4];
        // N beyond the disc: a step too far, whatever its sum says.
        return lobe.outside ? splat(4.0f) : 1.0f - explained;
    }
};

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

// One lane's state is one texel's search; all lanes evaluate together, each at its own trial point.
void minimise(const FitProblem& problem, float* unknowns, float* error)
{
    const auto row = [&](int i) { return load(unknowns + i * W); };
    const Objective objective{problem, row(kX), row(kY), row(kB11), row(kB21), row(kB22)};
    const int n = problem.isotropic ? 3 : 5;
    constexpr float kArmijo = 1e-4f, kLongestStep = 1.0f;
    V x[5] = {V{}, V{}, row(kL1), row(kL2), row(kL3)};
    V g[5], direction[5], trial[5], trialG[5];
    V f = objective(x, g);
    Hessian hessian{};
    const auto resetHessian = [&](I mask) {
        for (int i = 0; i < n; ++i)
            for (int j = 0; j <= i; ++j)
                hessian.h[i][j] = mask ? splat(i != j             ? 0.0f
                                               : n == 3 && i == 2 ? 0.5f
                                                                  : 1.0f)
                                       : hessian.h[i][j];
    };
    resetHessian(I{} == 0);
    V step = splat(0.0f), slope{};
    I active = f < 2.0f; // lanes still searching
    I fresh = active;    // lanes that need a new direction
    for (int evaluation = 1; evaluation < problem.maxEvaluations && any(active); ++evaluation) {
        V slopeNew{}, longest{};
        V candidate[5];
        for (int pass = 0; pass < 2; ++pass) {
            slopeNew = longest = V{};
            for (int i = 0; i < n; ++i) {
                candidate[i] = V{};
                for (int j = 0; j < n; ++j)
                    candidate[i] -= hessian.at(i, j) * g[j];
                slopeNew += candidate[i] * g[i];
                longest = maximum(longest, magnitude(candidate[i]));
            }
            const I bad = fresh & (slopeNew >= 0.0f);
            if (!any(bad))
                break;
            resetHessian(bad);
        }
        step = fresh ? minimum(splat(1.0f), kLongestStep / maximum(longest, splat(1e-20f))) : step;
        slope = fresh ? slopeNew : slope;
        for (int i = 0; i < n; ++i) {
            direction[i] = fresh ? candidate[i] : direction[i];
            trial[i] = x[i] + step * direction[i];
        }
        const V trialF = objective(trial, trialG);
        const I accepted = active & (trialF <= f + kArmijo * step * slope);
        V s[5], y[5], largest{};
        for (int i = 0; i < n; ++i) {
            s[i] = trial[i] - x[i];
            y[i] = trialG[i] - g[i];
        }
        updateHessian(hessian, s, y, accepted, n);
        const V gain = f - trialF;
        for (int i = 0; i < n; ++i) {
            x[i] = accepted ? trial[i] : x[i];
            g[i] = accepted ? trialG[i] : g[i];
            largest = maximum(largest, magnitude(g[i]));
        }
        // Backtrack to the minimum of the parabola through f, its slope and the trial.
        const V parabola = -0.5f * slope * step * step / maximum(trialF - f - slope * step, splat(1e-20f));
        const V shorter = minimum(maximum(parabola, 0.1f * step), 0.5f * step);
        step = accepted ? step : shorter;
        f = accepted ? trialF : f;
        const I settled = (largest < problem.tolerance) |
                          (accepted & (gain < 1e-3f * problem.tolerance) & (step >= 0.99f)) | (step < 1e-4f);
        active &= ~settled;
        fresh = accepted;
    }
    store(unknowns + kX * W, objective.originX + objective.b11 * x[0]);
    store(unknowns + kY * W, objective.originY + objective.b21 * x[0] + objective.b22 * x[1]);
    store(unknowns + kL1 * W, x[2]);
    store(unknowns + kL2 * W, problem.isotropic ? x[2] : x[3]);
    store(unknowns + kL3 * W, problem.isotropic ? V{} : x[4]);
    store(error, f);
}

} // namespace

extern const Kernels LUMEL_KERNELS;
const Kernels LUMEL_KERNELS = {LUMEL_NAME, W, average, evaluate, minimise};

} // namespace lumel::baker
