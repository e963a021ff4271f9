// Light from the environment: an environment map, filtered once for rough and smooth lobes.
//
// The specular part is a product of two averages (Karis 2013, "Real Shading in Unreal Engine 4", the split
// sum): of the radiance around the reflected direction, and of the reflectance (F0 + (F90 - F0) grazingShare, see
// energy.h: at F0 = 1 all comes back). The diffuse
// part is a quadratic form in N (Ramamoorthi and Hanrahan 2001, "An Efficient Representation for Irradiance
// Environment Maps"). Both are of the lobe of shading.h, so that an environment and a light of the same
// strength look the same.
#ifndef LUMEL_SHARED_ENVIRONMENT_H
#define LUMEL_SHARED_ENVIRONMENT_H
#include "limits.h"
#include "structs.h"
LUMEL_SHARED_BEGIN

// Directions in a square: the octahedron of Engelhardt and Dachsbacher 2008 ("Octahedron Environment Maps"), up in
// the middle. A margin repeats what lies across the square's border, wide enough for bilinear lookups in the
// coarsest level: its outermost texel centres lie on the border.
LUMEL_CONST uint kEnvironmentSize = 512u; // texels per side of level 0
LUMEL_CONST uint kEnvironmentLevels = 7u; // down to 8 texels per side
LUMEL_CONST float kEnvironmentMargin = 0.0625f; // of the side

LUMEL_FN float signOf(float x)
{
    return x < 0.0f ? -1.0f : 1.0f;
}

// Where a direction is in the texture, (0, 0) to (1, 1).
LUMEL_FN vec2 environmentPlace(vec3 d)
{
    float sum = max(abs(d.x) + abs(d.y) + abs(d.z), 1e-20f);
    float x = d.x / sum, y = d.z / sum;
    float foldedX = (1.0f - abs(y)) * signOf(x), foldedY = (1.0f - abs(x)) * signOf(y);
    vec2 p = d.y < 0.0f ? vec2(foldedX, foldedY) : vec2(x, y);
    return vec2(0.5f, 0.5f) + p * (0.5f - kEnvironmentMargin);
}

// The unit direction of a place in the texture; the margin mirrors what lies across the border.
LUMEL_FN vec3 environmentDirection(vec2 place)
{
    float x = (place.x - 0.5f) / (0.5f - kEnvironmentMargin), y = (place.y - 0.5f) / (0.5f - kEnvironmentMargin);
    if (abs(x) > 1.0f) {
        x = signOf(x) * (2.0f - abs(x));
        y = -y;
    }
    if (abs(y) > 1.0f) {
        y = signOf(y) * (2.0f - abs(y));
        x = -x;
    }
    float height = 1.0f - abs(x) - abs(y);
    float foldedX = (1.0f - abs(y)) * signOf(x), foldedY = (1.0f - abs(x)) * signOf(y);
    vec3 d = height < 0.0f ? vec3(foldedX, height, foldedY) : vec3(x, height, y);
    return normalize(d);
}

// Covariances of the lobes that the levels are filtered for: a hundred times the standard deviation from the
// first to the last, in even steps of its logarithm. Level 0 is the map itself.
LUMEL_FN float environmentVariance(float level)
{
    return pow(1e4f, level / float(kEnvironmentLevels - 1u) - 1.0f);
}
LUMEL_FN float environmentLevel(float variance)
{
    float octaves = log2(clamp(variance, 1e-4f, 1.0f)); // 0 at the roughest, -13.3 at the smoothest
    return float(kEnvironmentLevels - 1u) * (1.0f + octaves / 13.2877124f);
}

// Where a lobe gathers light from, for view angles of cosine nDotV and a covariance of the lobe, the inverse of its
// power. Fitted to numeric integrals of shading.h's reflectLight, in the manner of Karis 2014 ("Physically Based
// Shading on Mobile"): see tests/unit/scene/environment_test.cpp.
struct EnvironmentLobe {
    float towardsNormal; // how far the mean direction lies from the reflected one towards N
    float narrowing; // of the lobe's variance, since seen at a grazing angle it is narrower across
};
LUMEL_FN EnvironmentLobe environmentLobe(float nDotV, float variance)
{
    float s = clamp(variance, 1e-4f, 1.0f), deviation = sqrt(s), m = clamp(nDotV, 0.0f, 1.0f);
    EnvironmentLobe lobe;
    lobe.towardsNormal = 3.5f * s / (1.0f + 5.0f * s);
    // The cosine of the mean angle between half vector and view: half vectors gather where light comes from
    // above the surface.
    lobe.narrowing = m + (0.3f - 0.46f * m) * 2.6f * deviation / (1.0f + 1.6f * deviation);
    return lobe;
}

// A world direction in the map's axes.
LUMEL_FN vec3 environmentTurned(EnvironmentView environment, vec3 d)
{
    vec2 turn = environment.turn;
    return vec3(turn.x * d.x - turn.y * d.z, d.y, turn.y * d.x + turn.x * d.z);
}

// Radiance that a white matte surface of normal n reflects: irradiance over pi. Ramamoorthi and Hanrahan 2001,
// eq. 13, with the coefficients' constants multiplied in (scene/environment.cpp).
LUMEL_FN vec3 environmentDiffuse(EnvironmentView environment, vec3 normal)
{
    vec3 n = environmentTurned(environment, normal);
    vec3 e = environment.diffuse[0] + environment.diffuse[1] * n.x + environment.diffuse[2] * n.y +
             environment.diffuse[3] * n.z + environment.diffuse[4] * (n.x * n.y) +
             environment.diffuse[5] * (n.y * n.z) + environment.diffuse[6] * (n.x * n.z) +
             environment.diffuse[7] * (n.x * n.x - n.y * n.y) + environment.diffuse[8] * (n.z * n.z);
    // A sun brighter than all the rest makes the quadric dip below zero on the far side.
    return max(e, vec3(0.0f, 0.0f, 0.0f));
}

LUMEL_SHARED_END
#endif
