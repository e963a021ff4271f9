#include "ggx_reference.h"
#include <algorithm>
#include <cmath>
#include <numbers>

namespace lumel::test {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

// Walter et al. 2007, "Microfacet Models for Refraction through Rough Surfaces", eq. 33.
float distribution(float nDotH, float alpha)
{
    const float a2 = alpha * alpha, t = 1.0f + (a2 - 1.0f) * nDotH * nDotH;
    return a2 / (kPi * t * t);
}

// Heitz 2014, "Understanding the Masking-Shadowing Function", eq. 99, over 4 N.l N.v.
float visibility(float nDotL, float nDotV, float alpha)
{
    const float a2 = alpha * alpha;
    const auto lambda = [&](float c) { return std::sqrt(a2 + (1.0f - a2) * c * c); };
    return 0.5f / (nDotL * lambda(nDotV) + nDotV * lambda(nDotL));
}

} // namespace

GgxReference::GgxReference(float perceptualRoughness, glm::vec3 f0, glm::vec3 diffuse)
    : alpha_(perceptualRoughness * perceptualRoughness), f0_(f0), diffuse_(diffuse)
{
    // Half vectors in proportion to D N.h: tan^2 = alpha^2 u / (1 - u) (Walter et al., eq. 35).
    constexpr int kRings = 128, kTurns = 64;
    for (int i = 0; i < kAngles; ++i) {
        const float nDotV = (float(i) + 0.5f) / kAngles;
        const glm::vec3 v(std::sqrt(1.0f - nDotV * nDotV), 0.0f, nDotV);
        double sum = 0.0;
        for (int ring = 0; ring < kRings; ++ring) {
            const float u = (float(ring) + 0.5f) / kRings;
            const float cosine = std::sqrt((1.0f - u) / (1.0f + (alpha_ * alpha_ - 1.0f) * u));
            const float sine = std::sqrt(1.0f - cosine * cosine);
            for (int turn = 0; turn < kTurns; ++turn) {
                const float phi = kPi * (float(turn) + 0.5f) / kTurns;
                const glm::vec3 h(sine * std::cos(phi), sine * std::sin(phi), cosine);
                const float vDotH = glm::dot(v, h), nDotL = 2.0f * vDotH * cosine - nDotV;
                if (vDotH > 0.0f && nDotL > 0.0f)
                    sum += double(visibility(nDotL, nDotV, alpha_) * nDotL * 4.0f * vDotH / cosine);
            }
        }
        single_[i] = float(sum / (kRings * kTurns));
    }
}

glm::vec3 GgxReference::reflectLight(glm::vec3 l, glm::vec3 v) const
{
    if (l.z <= 0.0f || v.z <= 0.0f)
        return glm::vec3(0.0f);
    const glm::vec3 h = glm::normalize(l + v);
    const float grazing = std::pow(1.0f - glm::dot(v, h), 5.0f);
    const glm::vec3 fresnel = f0_ + (1.0f - f0_) * grazing;
    const float single = single_[std::min(int(v.z * kAngles), kAngles - 1)];
    // Turquin 2019, "Practical multiple scattering compensation for microfacet models", eq. 16.
    const glm::vec3 compensation = 1.0f + f0_ * (1.0f / single - 1.0f);
    const glm::vec3 specular =
        fresnel * compensation * (distribution(h.z, alpha_) * visibility(l.z, v.z, alpha_));
    return (specular + (1.0f - fresnel) * diffuse_ / kPi) * l.z;
}

} // namespace lumel::test
