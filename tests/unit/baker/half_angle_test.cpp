// The refactoring that the fit rests on: over pairs (l, v) uniform on the hemisphere, half vectors are
// uniform on the unit disc (h.x, h.y), so the 4D error of a lobe is 4 pi times a 2D integral.
#include "oracle.h"
#include <gtest/gtest.h>
#include <random>

namespace lumel::baker {
namespace {
using namespace test;

struct Vec {
    double x, y, z;
};

Vec onHemisphere(std::mt19937_64& random)
{
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    const double z = uniform(random), phi = 2.0 * M_PI * uniform(random), r = std::sqrt(1.0 - z * z);
    return {r * std::cos(phi), r * std::sin(phi), z};
}

Vec halfVector(std::mt19937_64& random)
{
    const Vec l = onHemisphere(random), v = onHemisphere(random);
    const Vec s{l.x + v.x, l.y + v.y, l.z + v.z};
    const double length = std::sqrt(s.x * s.x + s.y * s.y + s.z * s.z);
    return {s.x / length, s.y / length, s.z / length};
}

OracleLobe randomLobe(std::mt19937_64& random)
{
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    const double pu = std::exp2(3.0 + 2.0 * uniform(random)), pv = std::exp2(3.0 + 2.0 * uniform(random));
    const double angle = 3.0 * uniform(random), c = std::cos(angle), s = std::sin(angle);
    return {0.5 * uniform(random),
            0.5 * uniform(random),
            c * c / pu + s * s / pv,
            c * s * (1.0 / pu - 1.0 / pv),
            s * s / pu + c * c / pv,
            1.0 + 0.5 * uniform(random),
            1.0};
}
} // namespace

// Density of h over solid angle 4 pi cos(theta), in units where the pairs have density 1 / (2 pi)^2 each:
// the share of half vectors in a part of the disc is the part's share of its area.
TEST(HalfAngle, DensityIsUniformOverTheDisc)
{
    constexpr int kPairs = 1000000, kRings = 8, kSectors = 4;
    std::mt19937_64 random(2026);
    std::vector<int> counts(kRings * kSectors, 0);
    for (int i = 0; i < kPairs; ++i) {
        const Vec h = halfVector(random);
        const int ring = std::min(kRings - 1, int((h.x * h.x + h.y * h.y) * kRings));
        const int sector =
            std::min(kSectors - 1, int((std::atan2(h.y, h.x) / (2.0 * M_PI) + 0.5) * kSectors));
        ++counts[size_t(ring * kSectors + sector)];
    }
    const double share = 1.0 / (kRings * kSectors);
    const double standardError = std::sqrt(kPairs * share * (1.0 - share));
    for (const int count : counts)
        EXPECT_NEAR(count, kPairs * share, 3.0 * standardError);
}

TEST(HalfAngle, ErrorOverPairsIsFourPiTimesTheDiscIntegral)
{
    std::mt19937_64 random(7);
    for (int i = 0; i < 20; ++i) {
        const OracleLobe g = randomLobe(random), f = randomLobe(random);
        constexpr int kPairs = 40000;
        double sum = 0.0, squares = 0.0;
        for (int k = 0; k < kPairs; ++k) {
            const Vec h = halfVector(random);
            const double d = g.ks * oracleShape(g, h.x, h.y, h.z) - f.ks * oracleShape(f, h.x, h.y, h.z);
            sum += d * d;
            squares += d * d * d * d;
        }
        const double measure = 4.0 * M_PI * M_PI; // of the pairs
        const double mean = sum / kPairs, deviation = std::sqrt(squares / kPairs - mean * mean);
        const double standardError = deviation / std::sqrt(double(kPairs));
        const OracleSums sums = oracleSums({g}, f, 300);
        const double disc = sums.gg - 2.0 * f.ks * sums.gf + f.ks * f.ks * sums.ff;
        EXPECT_NEAR(measure * mean, 4.0 * M_PI * disc, 3.0 * measure * standardError) << "pair " << i;
    }
}
} // namespace lumel::baker
