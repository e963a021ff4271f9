// Energy: how rough a glTF roughness is as a power, and the factors that keep a lobe's energy.
//
// The lobe p (N.h)^p with a visibility of 1 / (4 V) loses energy: its scale leaves out the cosine, half vectors
// near the horizon send light below it, and what rough microfacets reflect among themselves comes back only in
// part. A white metal in a white furnace must return 1 at any roughness. These factors ensure it:
//
//   energyFactor(s)       of the roughness alone. It is part of Ks at level 0, so the fit averages it exactly.
//   scatteringTint        what metals that are not white absorb between microfacets. Part of Ks too.
//   energyResidual(m, s)  what is left at a view cosine m; of the macro surface and the texel's mean roughness.
//   grazingShare(m, s)    the share of Fresnel's grazing part, which diffuse reflection does not get.
//
// s is the variance of an isotropic lobe, 1 / power, in [1e-4, 1]; m = Ng.v. All are fitted to numeric integrals
// of reflectLight (shading.h); tests/unit/core/energy_test.cpp integrates again and holds them within 2 %.
#ifndef LUMEL_SHARED_ENERGY_H
#define LUMEL_SHARED_ENERGY_H
#include "compat.h"
#include "limits.h"
LUMEL_SHARED_BEGIN

// Share of a lobe's energy by which powerFromRoughness compares two lobes.
LUMEL_CONST float kComparedEnergy = 0.75f;

// glTF perceptual roughness r in [0, 1] to the power of the lobe that looks alike: three quarters of its energy
// lie within the same angle of N as with GGX. alpha = r^2; of GGX (Walter et al. 2007, eq. 35) the share q lies
// within tan^2(angle) = alpha^2 q / (1 - q), of a Blinn-Phong distribution within cos(angle)^(p + 2) = 1 - q.
// q = 1/2 would match the core of highlights, but shows the tails of GGX too dark; q = 0.75 is close to the least
// error both of spheres under single lights and of reflected environment.
// Roughnesses below 0.098 and above 0.843 run into the limits of the power.
LUMEL_FN float powerFromRoughness(float perceptualRoughness)
{
    float alpha = perceptualRoughness * perceptualRoughness;
    float tangent2 = alpha * alpha * kComparedEnergy / (1.0f - kComparedEnergy);
    return clamp(-2.0f * log(1.0f - kComparedEnergy) / log(1.0f + max(tangent2, 1e-6f)) - 2.0f, kMinPower, kMaxPower);
}

// 1 / (the mean over a sphere of what the lobe reflects of a white furnace).
LUMEL_FN float energyFactor(float variance)
{
    float s = clamp(variance, 0.0f, 1.0f), d = sqrt(s);
    return 1.0f + s * (8.09f - 12.8f * d + s * (19.86f - 9.707f * d));
}

// Mean albedo of a white metal of GGX without multiple scattering (height-correlated Smith masking).
LUMEL_FN float singleScattering(float variance)
{
    float d = sqrt(clamp(variance, 0.0f, 1.0f));
    return 1.0f - d * (0.07f + d * (2.1f + d * (-3.0f + 1.3f * d)));
}

// Light that is scattered once more is reflected by F0 once more (Turquin 2019, "Practical multiple scattering
// compensation for microfacet models", eq. 16, over its energyFactor). single: singleScattering.
LUMEL_FN vec3 scatteringTint(vec3 f0, float single)
{
    return vec3(single, single, single) + min(f0, vec3(1.0f, 1.0f, 1.0f)) * (1.0f - single);
}

// How much of Smith's masking joins Kelemen's visibility (shading.h). Chosen so that spheres under one light are as
// bright as with GGX and multiple scattering; below a roughness of 0.7 it is negligible.
LUMEL_FN float smithShare(float variance)
{
    return variance * variance;
}

LUMEL_FN float energyResidual(float cosine, float variance)
{
    // At grazing angles only the clamped visibility is at work, within a pixel of the silhouette.
    float m = max(cosine, 0.1f), s = clamp(variance, 0.0f, 1.0f), d = sqrt(s);
    float x = m / (m + 2.0f * d);
    float c0 = -0.008f + d * (-0.777f + d * (6.106f - 3.752f * d));
    float c1 = 1.834f + d * (4.783f + d * (-21.571f + 15.981f * d));
    float c2 = -3.838f + d * (-13.51f + d * (61.747f - 42.408f * d));
    float c3 = 2.011f + d * (10.279f + d * (-46.149f + 29.363f * d));
    return exp(c0 + x * (c1 + x * (c2 + x * c3))) / energyFactor(s);
}

LUMEL_FN float grazingShare(float cosine, float variance)
{
    float m = clamp(cosine, 0.0f, 1.0f), s = clamp(variance, 0.0f, 1.0f), d = sqrt(s);
    float c0 = 0.909f + d * (-0.403f + 0.11f * d);
    float c1 = 0.407f + d * (-4.742f + 4.845f * d);
    float c2 = -6.026f + d * (28.654f - 28.566f * d);
    float c3 = 9.804f + d * (-47.529f + 48.291f * d);
    float c4 = -5.182f + d * (24.877f - 25.366f * d);
    // Schlick's (1 - v.h)^5 of a mean angle between half vector and view.
    float t = clamp(c0 + m * (c1 + m * (c2 + m * (c3 + m * c4))), 0.0f, 1.0f);
    float t2 = t * t;
    return t2 * t2 * t;
}

// The variances of a lobe of any covariance (S.xx, S.xy, S.yy) along its axes: the eigenvalues of S.
LUMEL_FN vec2 lobeVariances(vec3 covariance)
{
    float mean = 0.5f * (covariance.x + covariance.z), difference = 0.5f * (covariance.x - covariance.z);
    float spread = sqrt(difference * difference + covariance.y * covariance.y);
    return vec2(mean + spread, max(mean - spread, 0.0f));
}

// Ks of a level-0 lobe: F0 with its factors. Of an anisotropic lobe they are the geometric means of both axes',
// which is within 3 % of the integral.
LUMEL_FN vec3 specularStrength(vec3 f0, vec3 covariance)
{
    vec2 s = lobeVariances(covariance);
    float factor = sqrt(energyFactor(s.x) * energyFactor(s.y));
    float single = sqrt(singleScattering(s.x) * singleScattering(s.y));
    return factor * f0 * scatteringTint(f0, single);
}

// Its inverse.
LUMEL_FN vec3 reflectanceOf(vec3 specular, vec3 covariance)
{
    vec2 s = lobeVariances(covariance);
    vec3 tinted = specular / sqrt(energyFactor(s.x) * energyFactor(s.y));
    float single = sqrt(singleScattering(s.x) * singleScattering(s.y));
    // F0 (single + (1 - single) F0) = tinted up to 1, the root without cancellation; above it F0 = tinted, and less
    // than the root.
    vec3 singles = vec3(single, single, single);
    vec3 root = sqrt(singles * singles + 4.0f * (1.0f - single) * tinted);
    return max(2.0f * tinted / (singles + root), tinted);
}

// The isotropic lobe of the same energyFactor.
LUMEL_FN float baseVariance(vec3 covariance)
{
    vec2 s = lobeVariances(covariance);
    if (s.x - s.y < 1e-3f * s.x)
        return s.x;
    float factor = sqrt(energyFactor(s.x) * energyFactor(s.y));
    // It grows with the variance: bisection between the two.
    for (int i = 0; i < 12; ++i) {
        float middle = 0.5f * (s.x + s.y);
        if (energyFactor(middle) > factor)
            s.x = middle;
        else
            s.y = middle;
    }
    return 0.5f * (s.x + s.y);
}

LUMEL_SHARED_END
#endif
