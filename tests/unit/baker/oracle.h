// An independent, slow evaluation of the error of a texel: plain double precision, a dense grid over the
// disc, the lobe from its definition. Shares no code with the baker.
#pragma once
#include "baker/bake.h"
#include <cmath>
#include <vector>

namespace lumel::baker::test {

struct OracleLobe {
    double nx, ny, sxx, sxy, syy, ks, share;
};

inline double oracleShape(const OracleLobe& l, double x, double y, double z)
{
    const double nz = std::sqrt(std::max(0.0, 1.0 - l.nx * l.nx - l.ny * l.ny));
    const double c = l.nx * x + l.ny * y + nz * z;
    if (c <= 0.0)
        return 0.0;
    const double r = std::sqrt(1.0 - l.nx * l.nx);
    const double a = (x - l.nx * c) / r, b = (nz * y - l.ny * z) / r,
                 s = std::min(a * a + b * b, 1.0 - 1e-15);
    const double det = l.sxx * l.syy - l.sxy * l.sxy;
    const double q = (l.syy * a * a - 2.0 * l.sxy * a * b + l.sxx * b * b) / det;
    const double k = s < 1e-7 ? 0.5 : -std::log1p(-s) / (2.0 * s);
    return std::exp(-q * k) / std::sqrt(det);
}

struct OracleSums {
    double gg = 0.0, gf = 0.0, ff = 0.0; // <G,G>, <G,f>, <f,f>
    double g = 0.0, f = 0.0;             // integrals of G and f
    double relativeError(double ks) const { return (gg - 2.0 * ks * gf + ks * ks * ff) / gg; }
    double bestError() const { return 1.0 - gf * gf / (gg * ff); }
};

// `cells` x `cells` midpoints over the square around the disc.
inline OracleSums oracleSums(const std::vector<OracleLobe>& lobes, const OracleLobe& fit, int cells)
{
    OracleSums sums;
    const double h = 2.0 / cells, area = h * h;
    for (int j = 0; j < cells; ++j)
        for (int i = 0; i < cells; ++i) {
            const double x = -1.0 + (i + 0.5) * h, y = -1.0 + (j + 0.5) * h;
            const double z2 = 1.0 - x * x - y * y;
            if (z2 <= 0.0)
                continue;
            const double z = std::sqrt(z2);
            double g = 0.0;
            for (const OracleLobe& l : lobes)
                g += l.share * l.ks * oracleShape(l, x, y, z);
            const double f = oracleShape(fit, x, y, z);
            sums.gg += area * g * g;
            sums.gf += area * g * f;
            sums.ff += area * f * f;
            sums.g += area * g;
            sums.f += area * f;
        }
    return sums;
}

// Calls `visit` with the half vector and the area of each midpoint on the disc.
template<class Visit>
void forDisc(int cells, const Visit& visit)
{
    const double h = 2.0 / cells;
    for (int j = 0; j < cells; ++j)
        for (int i = 0; i < cells; ++i) {
            const double x = -1.0 + (i + 0.5) * h, y = -1.0 + (j + 0.5) * h, z2 = 1.0 - x * x - y * y;
            if (z2 > 0.0)
                visit(x, y, std::sqrt(z2), h * h);
        }
}

// E of several lobes with the Ks that they have.
inline double oracleError(const std::vector<OracleLobe>& lobes, const std::vector<OracleLobe>& fit, int cells)
{
    double energy = 0.0, error = 0.0;
    forDisc(cells, [&](double x, double y, double z, double area) {
        double g = 0.0, f = 0.0;
        for (const OracleLobe& l : lobes)
            g += l.share * l.ks * oracleShape(l, x, y, z);
        for (const OracleLobe& l : fit)
            f += l.ks * oracleShape(l, x, y, z);
        energy += area * g * g;
        error += area * (g - f) * (g - f);
    });
    return error / energy;
}

// The least E of any two of the candidates, each pair with its best Ks, none below 0.
inline double bestPairError(const std::vector<OracleLobe>& lobes, const std::vector<OracleLobe>& candidates,
                            int cells)
{
    const size_t count = candidates.size();
    std::vector<double> overlaps(count), gram(count * count), f(count);
    double energy = 0.0;
    forDisc(cells, [&](double x, double y, double z, double area) {
        double g = 0.0;
        for (const OracleLobe& l : lobes)
            g += l.share * l.ks * oracleShape(l, x, y, z);
        energy += area * g * g;
        for (size_t i = 0; i < count; ++i) {
            f[i] = oracleShape(candidates[i], x, y, z);
            overlaps[i] += area * g * f[i];
            for (size_t j = 0; j <= i; ++j)
                gram[i * count + j] += area * f[i] * f[j];
        }
    });
    double most = 0.0;
    for (size_t i = 0; i < count; ++i)
        for (size_t j = 0; j < i; ++j) {
            const double a = gram[i * count + i], b = gram[j * count + j], c = gram[i * count + j],
                         det = a * b - c * c;
            const double k1 = (overlaps[i] * b - overlaps[j] * c) / det,
                         k2 = (overlaps[j] * a - overlaps[i] * c) / det;
            most = std::max(most, overlaps[i] * overlaps[i] / a);
            if (k1 > 0.0 && k2 > 0.0)
                most = std::max(most, k1 * overlaps[i] + k2 * overlaps[j]);
        }
    return 1.0 - most / energy;
}

inline OracleLobe oracleLobe(const float* texel, double share = 1.0)
{
    return {texel[kNx], texel[kNy], texel[kSxx], texel[kSxy], texel[kSyy], texel[kKsR], share};
}

// The level-0 lobes under texel (x, y) of a level of a chain whose size is a power of two there.
inline std::vector<OracleLobe> lobesUnder(const ReflectanceMips& mips, size_t level, int x, int y)
{
    const Level& base = mips.levels[0];
    const int w = base.width / mips.levels[level].width, h = base.height / mips.levels[level].height;
    std::vector<OracleLobe> lobes;
    for (int j = y * h; j < (y + 1) * h; ++j)
        for (int i = x * w; i < (x + 1) * w; ++i)
            lobes.push_back(oracleLobe(base.at(i, j), 1.0 / (w * h)));
    return lobes;
}

} // namespace lumel::baker::test
