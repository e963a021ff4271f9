// From lobes to radiance: the one BRDF of every shading mode.
//
//   Lo = sum over lights Ei [ Kd/pi (N.l)+ + Fresnel(v.h) F(h)/(2 pi) / (4 max(l.h, eps)^2) (Ng.l)+ ]
//
// F(h)/(2 pi) is the half-angle distribution, 1/(4 (l.h)^2) the visibility of Kelemen and Szirmay-Kalos
// 2001 ("A Microfacet Based Coupled Specular-Matte BRDF Model", eq. 9). Neither it nor Fresnel depends
// on N, so every N-dependence of the specular term sits in F(h) and the baker's half-angle fit stays exact.
#ifndef LUMEL_SHARED_SHADING_H
#define LUMEL_SHARED_SHADING_H
#include "lobe.h"
#include "structs.h"
LUMEL_SHARED_BEGIN

// Smallest l.h in the visibility term: light and view then stand 168 degrees apart.
LUMEL_CONST float kMinLightDotHalf = 0.1f;

// Schlick 1994, "An Inexpensive BRDF Model for Physically-based Rendering", eq. 15, times Ks instead of
// F0. The grazing value is 1 except below reflectances of 2 %, which no material has: there it fades, so
// that Ks = 0 means no specular at all (Lagarde and de Rousiers 2014, section 3.1.4).
LUMEL_FN vec3 fresnelSchlick(vec3 specular, float vDotH)
{
    float m = clamp(1.0f - vDotH, 0.0f, 1.0f);
    float m2 = m * m;
    float grazing = clamp(50.0f * max(specular.x, max(specular.y, specular.z)), 0.0f, 1.0f);
    vec3 headroom = max(vec3(grazing, grazing, grazing) - specular, vec3(0.0f, 0.0f, 0.0f));
    return specular + headroom * (m2 * m2 * m);
}

struct SurfaceReflectance {
    Lobe lobe;           // in world space
    vec3 macroNormal;    // Ng, world space, on the viewer's side
    vec3 specular;       // Ks
    vec3 diffuse;        // Kd
};

// Radiance towards v from a light of the given irradiance (on a plane facing it) in direction l.
LUMEL_FN vec3 reflectLight(SurfaceReflectance surface, vec3 l, vec3 v, vec3 irradiance)
{
    vec3 radiance = surface.diffuse * (max(dot(surface.lobe.normal, l), 0.0f) / kPi);
    float ngDotL = dot(surface.macroNormal, l);
    if (ngDotL > 0.0f) {
        vec3 h = normalize(l + v);
        float lDotH = max(dot(l, h), kMinLightDotHalf);
        float specular = lobeShape(surface.lobe, h) * ngDotL / (8.0f * kPi * lDotH * lDotH);
        radiance += fresnelSchlick(surface.specular, lDotH) * specular;
    }
    return radiance * irradiance;
}

// A hemisphere of constant sky and ground radiance. Its irradiance over pi is linear in N.up, so it averages
// exactly; the specular part uses that a constant environment reflects as Ks times its radiance.
LUMEL_FN vec3 reflectAmbient(SurfaceReflectance surface, vec3 sky, vec3 ground)
{
    float t = 0.5f + 0.5f * surface.lobe.normal.y;
    return (surface.diffuse + surface.specular) * mix(ground, sky, t);
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
