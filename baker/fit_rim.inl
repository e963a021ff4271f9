// The part of <f, f> that the rim of the disc cuts off. The closed form of fit_exact.inl runs over the
// hemisphere around N and weighs half vectors below the horizon with their negative h.z; the disc ends
// at the horizon, so
//     <f, f> = closed form + integral of f^2 |h.z| over the lune {N.h > 0, h.z < 0}.
// The lune's edges meet along t = (-N.y, N.x, 0) / |N.xy|. With d = N.xy / |N.xy|, theta = the tilt of N:
//     h = y t + sqrt(1 - y^2) (sqrt(1 - x^2) d - x z),   x = sin(alpha), alpha in (0, theta), y in (-1, 1),
//     d(omega) = dy dalpha = dy dx / sqrt(1 - x^2),  |h.z| = sqrt(1 - y^2) x.
// Seen from N, such an h lies U = N.z sqrt(1 - x^2) + |N.xy| x away towards the horizon and y across, times
// sqrt(1 - y^2) and 1. With P turned into these axes, f^2 there is about
//     exp(-P_c U^2 - P_tt (y - y*)^2),   P_c = det P / P_tt,   y* = -P_ut U / P_tt,
// which says where the Gauss-Legendre nodes go and how far they need to reach.

constexpr int kRimXs = 5, kRimYs = 8;
constexpr float kGauss5[2][5] = {{0.04691008f, 0.23076534f, 0.5f, 0.76923466f, 0.95308992f},
                                 {0.11846344f, 0.23931434f, 0.28444444f, 0.23931434f, 0.11846344f}};
constexpr float kGauss8[2][8] = {
    {-0.96028986f, -0.79666648f, -0.52553241f, -0.18343464f, 0.18343464f, 0.52553241f, 0.79666648f,
     0.96028986f},
    {0.10122854f, 0.22238103f, 0.31370665f, 0.36268378f, 0.36268378f, 0.31370665f, 0.22238103f, 0.10122854f}};

// Off which lanes' lobes does the rim cut a visible part (1e-5)? At the rim f^2 has fallen to
// |N.xy|^(2 p), p the lobe's power there, which the smaller eigenvalue of P bounds from below.
LUMEL_INLINE I rimMatters(const Lobe& lobe)
{
    const V half = 0.5f * (lobe.pxx - lobe.pyy), mean = 0.5f * (lobe.pxx + lobe.pyy);
    const V lowest = mean - squareRoot(half * half + lobe.pxy * lobe.pxy);
    const V r2 = lobe.frame.nx * lobe.frame.nx + lobe.frame.ny * lobe.frame.ny;
    // ln(r^2) <= 4 (sqrt r - 1) <= 0.
    const V logR2 = 4.0f * (squareRoot(squareRoot(r2)) - 1.0f);
    return (lowest + 1.0f) * logR2 > -11.5f;
}

// Sums over the lune of f^2 |h.z| / det P, with the same factors as sumNodes().
LUMEL_INLINE Sums sumRim(const Lobe& lobe)
{
    Sums sum{};
    const Frame& f = lobe.frame;
    const V r2 = maximum(f.nx * f.nx + f.ny * f.ny, splat(1e-6f));
    const V r = squareRoot(r2), inverseR = 1.0f / r;
    const V dx = f.nx * inverseR, dy = f.ny * inverseR;
    // u = (N.z d, -|N.xy|) and t in the lobe's frame.
    const V ua = f.nz * dx * f.inverseR, ub = (f.nz * f.nz * dy + f.ny * r) * f.inverseR;
    const V ta = -dy * f.inverseR, tb = f.nz * dx * f.inverseR;
    const V ptt = lobe.pxx * ta * ta + 2.0f * lobe.pxy * ta * tb + lobe.pyy * tb * tb;
    const V put = lobe.pxx * ua * ta + lobe.pxy * (ua * tb + ub * ta) + lobe.pyy * ub * tb;
    const V across = lobe.det / ptt;
    const V reachX = minimum(minimum(r, 4.0f * r / (f.nz * across)), 3.2f / squareRoot(across));
    const V reachY = 3.2f / squareRoot(ptt + 0.5f);
    for (int i = 0; i < kRimXs; ++i) {
        const V x = reachX * kGauss5[0][i];
        const V cosine = squareRoot(1.0f - x * x);
        const V peak = minimum(maximum(-put / ptt * (f.nz * cosine + r * x), splat(-1.0f)), splat(1.0f));
        const V from = maximum(peak - reachY, splat(-1.0f)), to = minimum(peak + reachY, splat(1.0f));
        const V share = kGauss5[1][i] * reachX * 0.5f * (to - from) * x / cosine;
        for (int j = 0; j < kRimYs; ++j) {
            const V y = 0.5f * (from + to) + 0.5f * (to - from) * kGauss8[0][j];
            const V level = squareRoot(maximum(1.0f - y * y, splat(0.0f)));
            const V out = level * cosine;
            const Point p = locate(f, out * dx - y * dy, out * dy + y * dx, -level * x);
            accumulate(sum, termsAt(p, lobe, 2.0f), kGauss8[1][j] * share * level);
        }
    }
    return sum;
}
