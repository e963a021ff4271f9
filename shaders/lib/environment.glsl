// What a surface reflects of the environment.
#ifndef LUMEL_ENVIRONMENT_GLSL
#define LUMEL_ENVIRONMENT_GLSL
#include "lib/interface.glsl"
#include "shared/environment.h"
#include "shared/shading.h"

layout(set = 0, binding = 2) uniform sampler2D environmentMap; // see shared/environment.h

vec3 environmentRadiance(vec3 d, float level)
{
    vec2 place = environmentPlace(environmentTurned(view.environment, d));
    vec3 ambient = mix(view.groundRadiance, view.skyRadiance, 0.5 + 0.5 * d.y);
    return textureLod(environmentMap, place, level).rgb * view.environment.intensity + ambient;
}

// Taps along a lobe's long axis: at most, and for each of its short deviations that a long one has.
const int kMostLobeTaps = 8;
const float kTapsPerRatio = 1.5;
const float kTapReach = 1.5; // deviations to either side; more carries no more weight than the taps' own width

vec3 reflectEnvironment(SurfaceReflectance surface, vec3 v)
{
    Lobe lobe = surface.lobe;
    // Eigenvalues of P, the powers along the lobe's short and long axis.
    vec3 p = lobe.inverseCovariance;
    float mean = 0.5 * (p.x + p.z), halfDifference = 0.5 * (p.x - p.z);
    float spread = sqrt(halfDifference * halfDifference + p.y * p.y);
    float shortVariance = 1.0 / (mean + spread), longVariance = 1.0 / max(mean - spread, 1.0);
    float ratio = sqrt(longVariance / shortVariance);
    int taps = ratio < 1.5 ? 1 : int(min(ceil(kTapsPerRatio * ratio), float(kMostLobeTaps)));
    // The long axis is the eigenvector of mean - spread.
    vec2 axis = p.x >= p.z ? vec2(p.y, -halfDifference - spread) : vec2(halfDifference - spread, p.y);
    axis = dot(axis, axis) > 1e-12 ? normalize(axis) : vec2(1.0, 0.0);
    vec3 along = lobe.tangentU * axis.x + lobe.tangentV * axis.y;
    // A tap is as wide as the lobe is across, or as wide as to leave no gaps along it.
    float meanVariance = sqrt(shortVariance * longVariance), gap = 2.0 * kTapReach / float(taps);
    float tapVariance = taps > 1 ? max(shortVariance, 0.25 * gap * gap * longVariance) : meanVariance;

    float nDotV = max(dot(lobe.normal, v), 0.0);
    EnvironmentLobe part = environmentLobe(nDotV, tapVariance);
    float level = environmentLevel(tapVariance * part.narrowing);
    vec3 sum = vec3(0.0);
    for (int i = 0;;) {
        float t = ((2.0 * float(i) + 1.0) / float(taps) - 1.0) * (taps > 1 ? kTapReach : 0.0);
        vec3 h = normalize(lobe.normal + along * (t * sqrt(longVariance)));
        vec3 mirrored = 2.0 * dot(h, v) * h - v;
        sum += environmentRadiance(mix(mirrored, h, part.towardsNormal), level);
        if (++i >= taps)
            break;
    }
    vec3 radiance = sum / float(taps);
    return radiance * reflectedShare(surface, grazingShare(nDotV, meanVariance));
}
#endif
