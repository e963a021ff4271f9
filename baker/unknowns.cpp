// Between lobes as they are stored and the minimiser's unknowns (fit_kernel.h).
#include "fit_kernel.h"
#include "solver.h"

namespace lumel::baker {

void toUnknowns(const Shape& shape, float maxLog, float* unknowns)
{
    const Sym2 s{shape.sxx, shape.sxy, shape.syy};
    const Sym2 p = s.inverse();
    constexpr double kFloor = 1.0 - double(kBase);
    const double u11 = std::sqrt(std::max(p.xx - double(kBase), kFloor));
    const double u12 = p.xy / u11;
    const double u22 = std::sqrt(std::max(p.yy - double(kBase) - u12 * u12, 1e-6));
    const double r2 = std::min(0.9999, double(shape.nx) * shape.nx + double(shape.ny) * shape.ny);
    const Sym2 disc = DiscFrame({shape.nx, shape.ny, std::sqrt(1.0 - r2)}).toDisc(s);
    const double b11 = std::sqrt(disc.xx), b21 = disc.xy / b11;
    unknowns[kX] = shape.nx;
    unknowns[kY] = shape.ny;
    unknowns[kL1] = std::min(std::log(float(u11)), maxLog);
    unknowns[kL2] = std::min(std::log(float(u22)), maxLog);
    unknowns[kL3] = float(u12 / u22);
    unknowns[kB11] = float(b11);
    unknowns[kB21] = float(b21);
    unknowns[kB22] = float(std::sqrt(std::max(disc.yy - b21 * b21, 1e-10)));
}

Shape fromUnknowns(const float* unknowns, float maxLog, bool& clamped)
{
    // The bounds that the search evaluated with (makeLobe in fit_lobe.inl).
    const double highest = maxLog, lowest = kLowestLog;
    const double e1 = std::exp(std::min(std::max(double(unknowns[kL1]), lowest), highest));
    const double e2 = std::exp(std::min(std::max(double(unknowns[kL2]), lowest), highest));
    const double shear = std::clamp(double(unknowns[kL3]) * e2, -std::exp(highest), std::exp(highest));
    const Sym2 p{double(kBase) + e1 * e1, e1 * shear, double(kBase) + e2 * e2 + shear * shear};
    const Sym2 raw = p.inverse(), s = clampPowers(raw);
    clamped = std::abs(s.xx - raw.xx) + std::abs(s.yy - raw.yy) > 1e-4 * (raw.xx + raw.yy);
    return {unknowns[kX], unknowns[kY], float(s.xx), float(s.xy), float(s.yy)};
}

} // namespace lumel::baker
