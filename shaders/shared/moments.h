// The one lobe that stands for several: it keeps their strength, mean and covariance (Olano and Baker 2010, "LEAN
// Mapping", section 3, with strengths as weights). Sums of K, K mu, K mu mu^T and K S give them: K is a lobe's strength,
// mu = N.xy. S is taken as it is, in the frame of its own normal: brought to the disc or to slopes first, errors differ
// by 1 to 3 %.
//
// Between the taps of an anisotropic lookup this is right, for the pixel covers them all. Between the texels of one
// trilinear tap it is not: there the average of two texels is one over twice a texel's area, and pictures lose by what
// that adds to the width of lobes (tests/unit/baker/moments_test.cpp). Taps take means, which samplers do; of two lobes
// those weighted by strength, since neighbours share out theirs differently.
#ifndef LUMEL_SHARED_MOMENTS_H
#define LUMEL_SHARED_MOMENTS_H
#include "lobe.h"
#include "meter.h"
LUMEL_SHARED_BEGIN

struct LobeMoments {
    float strength;  // sum of K
    vec2 mean;       // of K mu
    vec3 product;    // of K mu mu^T: xx, xy, yy
    vec3 covariance; // of K S
};

// Times this, products of strength and covariance are no subnormal half floats.
LUMEL_CONST float kSecondCovarianceScale = 64.0f;
// Added to the strength by which first lobes are premultiplied: what reflects nothing keeps its normal.
LUMEL_CONST float kLeastWeight = 1e-3f;

LUMEL_FN LobeMoments noMoments()
{
    LobeMoments sum;
    sum.strength = 0.0f;
    sum.mean = vec2(0.0f, 0.0f);
    sum.product = vec3(0.0f, 0.0f, 0.0f);
    sum.covariance = vec3(0.0f, 0.0f, 0.0f);
    return sum;
}

// K of Ks. Never 0: what reflects nothing has a normal for its diffuse part.
LUMEL_FN float lobeStrength(vec3 specular)
{
    return luminanceOf(specular) + 1e-6f;
}

LUMEL_FN LobeMoments plusLobe(LobeMoments sum, float strength, vec2 normal, vec3 covariance)
{
    sum.strength += strength;
    sum.mean += normal * strength;
    sum.product += vec3(normal.x * normal.x, normal.x * normal.y, normal.y * normal.y) * strength;
    sum.covariance += covariance * strength;
    return sum;
}

LUMEL_FN vec2 momentNormal(LobeMoments sum)
{
    return sum.mean / sum.strength;
}

// spread: times the covariance of the normals, see tapSpread().
LUMEL_FN vec3 momentCovariance(LobeMoments sum, float spread)
{
    vec2 n = momentNormal(sum);
    vec3 between = sum.product / sum.strength - vec3(n.x * n.x, n.x * n.y, n.y * n.y);
    return sum.covariance / sum.strength + max(between, vec3(0.0f, -1.0f, 0.0f)) * spread;
}

// Along a slope, the centres of n equal parts vary by 1 - 1 / n^2 of what the whole does.
LUMEL_FN float tapSpread(float n)
{
    return n > 1.0f ? n * n / (n * n - 1.0f) : 1.0f;
}

LUMEL_SHARED_END
#endif
