// The lobe that everything shares: shaders/shared/lobe.h.
#include "shared/lobe.h"
#include <cmath>
#include <random>

namespace {
using namespace lumel::shared;

// Design, section 1, in double precision and in the written form: Ks = 1, e = numerator / (1 - (N.h)^2).
double ashikhminShirley(double pu, double pv, glm::dvec3 n, glm::dvec3 h)
{
    const glm::dvec3 u = glm::normalize(glm::dvec3(1, 0, 0) - n * n.x), v = glm::cross(n, u);
    const double a = glm::dot(u, h), b = glm::dot(v, h), c = glm::dot(n, h);
    return std::sqrt(pu * pv) * std::pow(c, (pu * a * a + pv * b * b) / (1.0 - c * c));
}

glm::dvec3 randomDirection(std::mt19937& random, double lowestZ)
{
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    const double z = lowestZ + (1.0 - lowestZ) * uniform(random), phi = 6.283185307 * uniform(random);
    const double r = std::sqrt(1.0 - z * z);
    return {r * std::cos(phi), r * std::sin(phi), z};
}

// Rounded to float first, so that both sides see the same vectors.
glm::dvec3 rounded(glm::dvec3 v)
{
    return glm::normalize(glm::dvec3(glm::vec3(v)));
}
} // namespace

TEST(Lobe, EqualPowersAreBlinnPhong)
{
    std::mt19937 random(1);
    for (int i = 0; i < 2000; ++i) {
        const double p = std::exp2(13.0 * i / 2000.0);
        const glm::dvec3 n = rounded(randomDirection(random, 0.3));
        const glm::dvec3 h = rounded(n + randomDirection(random, -1.0) / std::sqrt(p));
        if (glm::dot(n, h) < 0.05)
            continue;
        const double c2 = 1.0 - glm::dot(glm::cross(n, h), glm::cross(n, h));
        const double blinnPhong = p * std::pow(c2, 0.5 * p);
        EXPECT_NEAR(ashikhminShirley(p, p, n, h) / blinnPhong, 1.0, 1e-6);
        const float s = float(1.0 / p);
        const float shared = lobeShape(vec3(n), vec3(s, 0.0f, s), vec3(h));
        // lobeShape works in float: the exponent, up to 10, carries 24 bits of each of its factors.
        EXPECT_NEAR(shared / blinnPhong, 1.0, 2e-5) << "power " << p;
    }
}

TEST(Lobe, MatchesTheWrittenFormForUnequalPowers)
{
    std::mt19937 random(2);
    for (int i = 0; i < 500; ++i) {
        const double pu = std::exp2(1.0 + i % 10), pv = std::exp2(1.0 + i % 7);
        const glm::dvec3 n = rounded(randomDirection(random, 0.3));
        const glm::dvec3 h = rounded(n + 0.2 * randomDirection(random, -1.0));
        if (1.0 - glm::dot(n, h) < 1e-4)
            continue;
        const float shared = lobeShape(vec3(n), vec3(float(1.0 / pu), 0.0f, float(1.0 / pv)), vec3(h));
        EXPECT_NEAR(shared, ashikhminShirley(pu, pv, n, h), 1e-4 * std::sqrt(pu * pv));
    }
}

TEST(Lobe, IsContinuousWhereTheHalfVectorMeetsTheNormal)
{
    const vec3 n(0.0f, 0.0f, 1.0f), s(1.0f / 400.0f, 0.0f, 1.0f / 25.0f);
    EXPECT_NEAR(lobeShape(n, s, n), 100.0f, 1e-3f);
    for (const double t : {1e-6, 1e-5, 1e-4, 1e-3}) {
        const vec3 h = vec3(glm::dvec3(t, t, std::sqrt(1.0 - 2.0 * t * t)));
        const double limit = 100.0 * std::exp(-0.5 * (400.0 * t * t + 25.0 * t * t));
        EXPECT_NEAR(lobeShape(n, s, h), limit, 1e-3 * limit);
    }
    // Both sides of the threshold where the series takes over.
    EXPECT_NEAR(lobeFalloff(0.02f - 1e-6f), lobeFalloff(0.02f + 1e-6f), 1e-5f);
    EXPECT_FLOAT_EQ(lobeFalloff(0.0f), 0.5f);
}

TEST(Lobe, VanishesContinuouslyAtTheHorizon)
{
    const vec3 n(0.0f, 0.0f, 1.0f), s(1.0f / 40.0f, 0.0f, 1.0f / 3.0f);
    float last = lobeShape(n, s, n);
    for (const float z : {0.5f, 0.1f, 1e-2f, 1e-3f, 1e-5f}) {
        const float value = lobeShape(n, s, vec3(0.0f, std::sqrt(1.0f - z * z), z));
        EXPECT_TRUE(std::isfinite(value));
        EXPECT_LE(value, last);
        last = value;
    }
    EXPECT_LT(last, 1e-5f);
    EXPECT_EQ(lobeShape(n, s, vec3(1.0f, 0.0f, 0.0f)), 0.0f);
    EXPECT_EQ(lobeShape(n, s, vec3(0.6f, 0.0f, -0.8f)), 0.0f);
}

// The transcript divides by (N.h)^2 and puts the exponential limit at N.h -> 0. Neither can hold: with
// equal powers that form is not Blinn-Phong, and towards the horizon it does not become the exponential.
TEST(Lobe, TranscriptsDenominatorIsNotBlinnPhong)
{
    const auto transcript = [](double p, double c) { return p * std::pow(c, p * (1.0 - c * c) / (c * c)); };
    const double p = 50.0, c = 0.9;
    EXPECT_GT(std::abs(transcript(p, c) / (p * std::pow(c, p)) - 1.0), 0.5);
    const double nearHorizon = 1e-3;
    EXPECT_LT(transcript(p, nearHorizon), 1e-100);
    EXPECT_GT(p * std::exp(-0.5 * p), 1e-100);
}

TEST(Lobe, NormalsBeyondTheDiscArePulledInside)
{
    for (const float r : {0.0f, 0.5f, 0.9999f, 1.0f, 3.0f}) {
        const vec3 n = lobeNormal(vec2(0.6f * r, 0.8f * r));
        EXPECT_NEAR(glm::length(n), 1.0f, 1e-4f);
        EXPECT_GT(n.z, 0.0f);
    }
}
