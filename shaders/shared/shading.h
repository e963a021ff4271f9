// From lobes to radiance: the one BRDF of every shading mode.
//
//   Lo = sum over lights Ei [ Kd' / pi (N.l)+ + Fresnel(v.h) R(v) F(h) / (2 pi) / (4 V) (Ng.l)+ ]
//
// F(h) / (2 pi) is the half-angle distribution and V = max(l.h, eps)^2 the visibility of Kelemen and Szirmay-Kalos
// 2001 ("A Microfacet Based Coupled Specular-Matte BRDF Model", eq. 9); of rough lobes a share is Smith's
// (energy.h). What depends on the lobe's own normal N sits in F(h) alone, which the baker's half-angle fit averages:
// V, Fresnel and R (energy.h) take h, the macro normal Ng and the texel's mean roughness.
//
// Exact in the average over a texel are F(h) up to the fit's error E, and Kd N up to the clamp of N.l. Not exact:
// Schlick's term multiplies the averaged F(h), so reflectance at normal incidence that varies together with normal
// or roughness is averaged apart from them; R and Smith's share take the mean roughness of the texels; E is that of
// the luminance of the specular part alone.
#ifndef LUMEL_SHARED_SHADING_H
#define LUMEL_SHARED_SHADING_H
#include "energy.h"
#include "lobe.h"
#include "structs.h"
LUMEL_SHARED_BEGIN

// Smallest l.h in the visibility term: light and view then stand 168 degrees apart.
LUMEL_CONST float kMinLightDotHalf = 0.1f;

// Reflectance at grazing angles (F90): 1 except below an F0 of 2 %, which no material has: there it fades, so that
// F0 = 0 means no specular at all (Lagarde and de Rousiers 2014, section 3.1.4).
LUMEL_FN float grazingReflectance(vec3 f0)
{
    return clamp(50.0f * max(f0.x, max(f0.y, f0.z)), 0.0f, 1.0f);
}

// What Fresnel adds to F0 from normal incidence to grazing angles.
LUMEL_FN vec3 grazingHeadroom(vec3 f0)
{
    float f90 = grazingReflectance(f0);
    return max(vec3(f90, f90, f90) - f0, vec3(0.0f, 0.0f, 0.0f));
}

// Schlick 1994, "An Inexpensive BRDF Model for Physically-based Rendering", eq. 15.
LUMEL_FN vec3 fresnelSchlick(vec3 f0, float vDotH)
{
    float m = clamp(1.0f - vDotH, 0.0f, 1.0f);
    float m2 = m * m;
    return f0 + grazingHeadroom(f0) * (m2 * m2 * m);
}

// A texel of a material on a surface, in world space.
struct SurfaceTexel {
    Lobe lobe;          // fitted
    vec3 macroNormal;   // Ng, on the viewer's side
    vec3 specular;      // Ks, fitted: F0 times its factors (energy.h), averaged, less what the fit loses
    vec3 f0;            // mean reflectance at normal incidence of the level-0 texels under it
    float baseVariance; // mean variance of the lobes of these, see energy.h
    vec3 diffuse;       // Kd
};

// The same as seen from one direction: all that does not depend on the light.
struct SurfaceReflectance {
    Lobe lobe;
    vec3 macroNormal;
    vec3 f0;
    vec3 strength;     // Ks R(v) / F0: multiplies Fresnel and the lobe
    vec3 tint;         // of F0 and Fresnel's grazing part together, see energy.h
    vec3 diffuse;      // Kd' = Kd less the share that the specular part reflects at grazing angles
    float grazing;     // that share, where F90 and tint are 1
    float smith;       // share of Smith's masking in the visibility
    float viewDotMacroNormal;
};

LUMEL_FN SurfaceReflectance reflectanceTowards(SurfaceTexel texel, vec3 v)
{
    SurfaceReflectance surface;
    surface.lobe = texel.lobe;
    surface.macroNormal = texel.macroNormal;
    surface.f0 = texel.f0;
    surface.viewDotMacroNormal = max(dot(texel.macroNormal, v), 0.0f);
    float residual = energyResidual(surface.viewDotMacroNormal, texel.baseVariance);
    surface.strength = texel.specular * residual / max(texel.f0, vec3(1e-6f, 1e-6f, 1e-6f));
    surface.smith = smithShare(texel.baseVariance);
    // As layers in MaterialX and OpenPBR: the base gets what the coat's directional albedo leaves. F0's own part is
    // left out of Kd when it is made.
    surface.grazing = grazingShare(surface.viewDotMacroNormal, texel.baseVariance);
    surface.tint = scatteringTint(texel.f0, singleScattering(texel.baseVariance));
    float most = max(surface.tint.x, max(surface.tint.y, surface.tint.z));
    surface.diffuse = texel.diffuse * (1.0f - grazingReflectance(texel.f0) * most * surface.grazing);
    return surface;
}

// The specular part's reflectance in a white furnace; grazing: grazingShare of the lobes that take part.
LUMEL_FN vec3 reflectedShare(SurfaceReflectance surface, float grazing)
{
    return surface.tint * (surface.f0 + grazingHeadroom(surface.f0) * grazing);
}

// A texel's second lobe, F = F1 + F2.
struct SecondLobe {
    Lobe lobe;
    vec3 strength;      // as the first one's
    vec3 share;         // of both lobes' Ks
    vec3 diffuseNormal; // that of Kd: their mean
};

// V; lDotH: at least kMinLightDotHalf.
LUMEL_FN float visibilityOf(SurfaceReflectance surface, float ngDotL, float lDotH)
{
    return mix(lDotH * lDotH, 0.5f * (ngDotL + surface.viewDotMacroNormal), surface.smith);
}

// Radiance towards v from a light of the given irradiance (on a plane facing it) in direction l.
LUMEL_FN vec3 reflectLight(SurfaceReflectance surface, vec3 l, vec3 v, vec3 irradiance)
{
    vec3 radiance = surface.diffuse * (max(dot(surface.lobe.normal, l), 0.0f) / kPi);
    float ngDotL = dot(surface.macroNormal, l);
    if (ngDotL > 0.0f) {
        vec3 h = normalize(l + v);
        float lDotH = max(dot(l, h), kMinLightDotHalf);
        float specular =
            lobeShape(surface.lobe, h) * ngDotL / (8.0f * kPi * visibilityOf(surface, ngDotL, lDotH));
        radiance += fresnelSchlick(surface.f0, lDotH) * surface.strength * specular;
    }
    return radiance * irradiance;
}

// The same of a surface of two lobes.
LUMEL_FN vec3 reflectLight(SurfaceReflectance surface, SecondLobe second, vec3 l, vec3 v, vec3 irradiance)
{
    vec3 radiance = surface.diffuse * (max(dot(second.diffuseNormal, l), 0.0f) / kPi);
    float ngDotL = dot(surface.macroNormal, l);
    if (ngDotL > 0.0f) {
        vec3 h = normalize(l + v);
        float lDotH = max(dot(l, h), kMinLightDotHalf);
        vec3 lobes = surface.strength * lobeShape(surface.lobe, h) + second.strength * lobeShape(second.lobe, h);
        float factor = ngDotL / (8.0f * kPi * visibilityOf(surface, ngDotL, lDotH));
        radiance += fresnelSchlick(surface.f0, lDotH) * lobes * factor;
    }
    return radiance * irradiance;
}

// A hemisphere of constant sky and ground radiance. Its irradiance over pi is linear in N.up, so it averages
// exactly; the specular part is what a white furnace shows.
LUMEL_FN vec3 reflectAmbient(SurfaceReflectance surface, vec3 normal, vec3 sky, vec3 ground)
{
    float t = 0.5f + 0.5f * normal.y;
    return (surface.diffuse + reflectedShare(surface, surface.grazing)) * mix(ground, sky, t);
}
LUMEL_FN vec3 reflectAmbient(SurfaceReflectance surface, vec3 sky, vec3 ground)
{
    return reflectAmbient(surface, surface.lobe.normal, sky, ground);
}

// What a punctual light sends to a point (KHR_lights_punctual).
struct Incident {
    vec3 direction;  // unit, from the point to the light
    vec3 irradiance; // on a plane facing the light
};

LUMEL_FN Incident incidentLight(Light light, vec3 position)
{
    Incident incident;
    if (light.type == kLightDirectional) {
        incident.direction = -light.direction;
        incident.irradiance = light.intensity;
        return incident;
    }
    vec3 toLight = light.position - position;
    float distance2 = max(dot(toLight, toLight), 1e-8f);
    incident.direction = toLight / sqrt(distance2);
    // The extension's recommended window: 1 - (distance / range)^4, inverseRange = 0 for no limit.
    float ratio2 = distance2 * light.inverseRange * light.inverseRange;
    float attenuation = clamp(1.0f - ratio2 * ratio2, 0.0f, 1.0f) / distance2;
    if (light.type == kLightSpot) {
        float cone = clamp(dot(-incident.direction, light.direction) * light.coneScale + light.coneOffset, 0.0f, 1.0f);
        attenuation *= cone * cone;
    }
    incident.irradiance = light.intensity * attenuation;
    return incident;
}

// May the light reach a ball of surface? Conservative: range and cone, not which way the surface faces.
LUMEL_FN bool lightReaches(Light light, vec3 centre, float radius)
{
    if (light.type == kLightDirectional)
        return true;
    vec3 toBall = centre - light.position;
    float distance = length(toBall);
    if (light.inverseRange * (distance - radius) > 1.0f)
        return false;
    if (light.type != kLightSpot || distance <= radius)
        return true;
    // The cone ends at the cosine c where c coneScale + coneOffset = 0. The ball meets it when its centre lies
    // within the outer angle plus the angle that its radius takes up.
    float cosOuter = clamp(-light.coneOffset / light.coneScale, -1.0f, 1.0f);
    float sinBall = radius / distance;
    float cosBall = sqrt(max(1.0f - sinBall * sinBall, 0.0f));
    float sinOuter = sqrt(max(1.0f - cosOuter * cosOuter, 0.0f));
    float cosSum = cosOuter * cosBall - sinOuter * sinBall;
    // Past 180 degrees together, the cone reaches all around.
    bool around = sinOuter * cosBall + cosOuter * sinBall < 0.0f;
    return around || dot(toBall, light.direction) >= cosSum * distance;
}

LUMEL_SHARED_END
#endif
