// The reflectance lobe: one formula for Blinn-Phong and Ashikhmin-Shirley, used by the baker that
// fits it, the shaders that light with it and the tests that check both.
//
// Everything lives in the tangent frame (x = T, y = B, z = Ng) of the macro surface. h is the unit
// half vector of light and view, N the lobe's own unit normal.
//
//   Blinn-Phong (Blinn 1977, normalised as in the talk):  F(h) = Ks p (N.h)^p
//   Ashikhmin-Shirley (2000, eq. 4, half-angle form):      F(h) = Ks sqrt(Pu Pv) (N.h)^e,
//       e = (Pu (Tu.h)^2 + Pv (Tv.h)^2) / (1 - (N.h)^2),
//       with the limit Ks sqrt(Pu Pv) exp(-(Pu (Tu.h)^2 + Pv (Tv.h)^2) / 2) as N.h -> 1.
//
// The transcript of Baker's talk "MIP-Mapping Reflectance Models" divides by (N.h)^2 and puts the
// limit at N.h -> 0. Both are slips: its own claims, that the lobe represents Blinn-Phong exactly
// and that the exponential is its limit, hold only for 1 - (N.h)^2 and N.h -> 1
// (see tests/unit/lobe_test.cpp, which shows that the transcript's form fails them).
//
// Form used here. Let a = Tu.h, b = Tv.h. (Tu, Tv, N) is orthonormal, so 1 - (N.h)^2 = a^2 + b^2 = s
// without cancellation, log(N.h) = log(1 - s) / 2, and
//
//   F(h) = Ks sqrt(det P) exp(-q k(s)),   q = [a b] P [a b]^T,   k(s) = -log(1 - s) / (2 s),
//
// which has both limits built in: k -> 1/2 as s -> 0 (the exponential), k -> infinity as s -> 1
// (N.h -> 0, where F -> 0). P = [[p, 0], [0, p]] gives q = p s and F = Ks p (N.h)^p: Blinn-Phong is
// the isotropic case, not a second code path. P is stored as its inverse S, the roughness
// covariance, because S filters linearly between texels (the argument of LEAN mapping, Olano and
// Baker 2010, section 3).
#ifndef LUMEL_SHARED_LOBE_H
#define LUMEL_SHARED_LOBE_H
#include "compat.h"
#include "limits.h"
LUMEL_SHARED_BEGIN

// k(s) = -log(1 - s) / (2 s) for s in [0, 1); 1/2 at s = 0. Below 0.02 the series (next term
// s^4/10 < 2e-8) avoids the division of two vanishing numbers.
LUMEL_FN float lobeFalloff(float s)
{
    if (s < 0.02f)
        return 0.5f + s * (0.25f + s * (1.0f / 6.0f + s * 0.125f));
    return -0.5f * log(max(1.0f - s, 1e-30f)) / s;
}

// Unit normal from its disc coordinates. |n| < 1; values on or outside the rim are pulled inside.
LUMEL_FN vec3 lobeNormal(vec2 n)
{
    float r2 = dot(n, n);
    float scale = r2 > 0.9999f ? sqrt(0.9999f / r2) : 1.0f;
    return vec3(n.x * scale, n.y * scale, sqrt(1.0f - min(r2, 0.9999f)));
}

// Tu: the frame's x axis projected onto the lobe's tangent plane. N.z > 0 keeps N away from x.
LUMEL_FN vec3 lobeTangentU(vec3 normal)
{
    return normalize(vec3(1.0f, 0.0f, 0.0f) - normal * normal.x);
}

// A lobe prepared for many half vectors: everything that does not depend on h. The three vectors may be
// rotated into any orthonormal space (the shaders light in world space) as long as h is in it too.
struct Lobe {
    vec3 normal;
    vec3 tangentU;
    vec3 tangentV;
    vec3 inverseCovariance; // P.xx, P.xy, P.yy in (tangentU, tangentV)
    float scale;    // sqrt(det P)
};

// covariance = (S.xx, S.xy, S.yy) in the frame (Tu, Tv) of the normal, positive definite: P = S^-1.
LUMEL_FN Lobe makeLobe(vec3 normal, vec3 covariance)
{
    Lobe lobe;
    lobe.normal = normal;
    lobe.tangentU = lobeTangentU(normal);
    lobe.tangentV = cross(normal, lobe.tangentU);
    float det = max(covariance.x * covariance.z - covariance.y * covariance.y, 1e-12f);
    lobe.inverseCovariance = vec3(covariance.z, -covariance.y, covariance.x) / det;
    lobe.scale = 1.0f / sqrt(det);
    return lobe;
}

// F(h) / Ks. 0 for half vectors behind the lobe (N.h <= 0).
LUMEL_FN float lobeShape(Lobe lobe, vec3 h)
{
    if (dot(lobe.normal, h) <= 0.0f)
        return 0.0f;
    float a = dot(lobe.tangentU, h);
    float b = dot(lobe.tangentV, h);
    float q = lobe.inverseCovariance.x * a * a + 2.0f * lobe.inverseCovariance.y * a * b + lobe.inverseCovariance.z * b * b;
    return lobe.scale * exp(-q * lobeFalloff(a * a + b * b));
}

LUMEL_FN float lobeShape(vec3 normal, vec3 covariance, vec3 h)
{
    return lobeShape(makeLobe(normal, covariance), h);
}

LUMEL_SHARED_END
#endif
