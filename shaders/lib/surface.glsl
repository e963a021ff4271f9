// From a point of a surface to its radiance: what the eye sees of it, the light loop.
// Used per lumel by the light pass and per pixel by forward.frag, so that both light the same way.
#ifndef LUMEL_SURFACE_GLSL
#define LUMEL_SURFACE_GLSL
#include "lib/environment.glsl"
#include "lib/interface.glsl"
#include "lib/shadow.glsl"
#include "shared/meter.h"
#include "shared/shading.h"

// Of what has two lobes; of no meaning elsewhere.
struct SecondSurfaceLobe {
    Lobe lobe;
    vec3 specular;
};

SecondSurfaceLobe noSecondLobe(Lobe first)
{
    return SecondSurfaceLobe(first, vec3(0.0));
}

// A point of a surface, whoever sees it.
struct SurfacePoint {
    SurfaceTexel texel; // double-sided surfaces: as seen from the front
    vec3 position;
    vec3 emitted;
    float occlusion;
    SecondSurfaceLobe second;
};

// A point of a surface as the lights see it.
struct ShadingPoint {
    SurfaceReflectance surface;
    vec3 position;
    vec3 toEye;
    vec3 radiance; // emitted, and reflected of what surrounds it
    SecondLobe second; // where there are two
};

Lobe seenFrom(float side, Lobe lobe)
{
    return Lobe(side * lobe.normal, side * lobe.tangentU, side * lobe.tangentV, lobe.inverseCovariance, lobe.scale);
}

// That of Kd, of two lobes: their mean by strength, taken as texels have it, on the disc around the macro normal.
vec3 meanNormal(SurfaceTexel texel, SecondSurfaceLobe second)
{
    float first = luminanceOf(texel.specular), other = luminanceOf(second.specular);
    vec3 mean = mix(texel.lobe.normal, second.lobe.normal, other / max(first + other, 1e-6));
    vec3 onDisc = mean - texel.macroNormal * dot(mean, texel.macroNormal);
    return onDisc + texel.macroNormal * sqrt(max(1.0 - dot(onDisc, onDisc), 0.0));
}

// texel: as seen from that side.
SecondLobe secondTowards(SurfaceTexel texel, SurfaceReflectance surface, SecondSurfaceLobe second, float side)
{
    second.lobe = seenFrom(side, second.lobe);
    vec3 both = max(texel.specular + second.specular, vec3(1e-6));
    float residual = energyResidual(surface.viewDotMacroNormal, texel.baseVariance);
    return SecondLobe(second.lobe, second.specular * residual / max(texel.f0, vec3(1e-6)), second.specular / both,
                      meanNormal(texel, second));
}

// What surrounds the surface, of two lobes or one. Each reflects its share: that of one alone does not depend on Ks.
vec3 reflectAround(SurfaceReflectance surface, SecondLobe second, vec3 toEye)
{
    vec3 diffuseNormal = kTwoLobes ? second.diffuseNormal : surface.lobe.normal;
    if ((kFeatures & kFeatureEnvironment) == 0u)
        return reflectAmbient(surface, diffuseNormal, view.skyRadiance, view.groundRadiance);
    vec3 diffuse = surface.diffuse * environmentDiffuse(view.environment, diffuseNormal);
    if (!kTwoLobes)
        return diffuse + reflectEnvironment(surface, toEye);
    SurfaceReflectance other = surface;
    other.lobe = second.lobe;
    return diffuse + (1.0 - second.share) * reflectEnvironment(surface, toEye) +
           second.share * reflectEnvironment(other, toEye);
}

// As the frame's eye sees it. flags: of the object.
ShadingPoint shadingPoint(uint flags, SurfacePoint point)
{
    vec3 toEye = normalize(view.eyeInWorld - point.position);
    SurfaceTexel texel = point.texel;
    // Seen from behind, a bump is a dent: it is the map's normal that is reversed, and with it the whole frame.
    bool flip = (flags & kObjectDoubleSided) != 0u && dot(texel.macroNormal, toEye) < 0.0;
    float side = flip ? -1.0 : 1.0;
    vec3 n = side * texel.macroNormal;
    texel.macroNormal = n;
    texel.lobe = seenFrom(side, texel.lobe);
    // Lumels just behind the silhouette are filtered into pixels before it: they are lit as seen along their
    // horizon, so that no highlight of a surface seen from behind leaks around the edge.
    toEye = normalize(toEye - n * min(dot(n, toEye), 0.0) + 1e-6 * n);
    SurfaceReflectance surface = reflectanceTowards(texel, toEye);
    SecondLobe second = secondTowards(texel, surface, point.second, side);
    vec3 around = reflectAround(surface, second, toEye);
    return ShadingPoint(surface, point.position, toEye, point.emitted + around * point.occlusion, second);
}

vec3 reflectIncident(ShadingPoint point, vec3 toLight, vec3 irradiance)
{
    if (kTwoLobes)
        return reflectLight(point.surface, point.second, toLight, point.toEye, irradiance);
    return reflectLight(point.surface, toLight, point.toEye, irradiance);
}

vec3 reflectedFrom(ShadingPoint point, Light light)
{
    Incident incident = incidentLight(light, point.position);
    return reflectIncident(point, incident.direction, incident.irradiance);
}

// Word `word` of the list of lights that may reach what is shaded, as in JobTile: each shader has its own.
uint listedLights(uint word);
// Bit i: the light of view.shadows[i] is in the list.
uint listedShadows();
// How much of that light reaches the point.
float listedVisibility(uint shadow, ShadingPoint point, vec3 toLight);

uint shadowsAmongListed()
{
    uint shadows = 0u;
    for (uint i = 0u; i < view.shadowCount; ++i) {
        uint light = view.shadows[i].light;
        shadows |= (listedLights(light / 32u) >> (light % 32u) & 1u) << i;
    }
    return shadows;
}

// From the listed lights that have a shadow map.
vec3 reflectedFromShadowed(ShadingPoint point)
{
    vec3 radiance = vec3(0.0);
    for (uint bits = listedShadows(); bits != 0u;) {
        uint i = findLSB(bits);
        Incident incident = incidentLight(lights[view.shadows[i].light], point.position);
        float visible = listedVisibility(i, point, incident.direction);
        radiance += reflectIncident(point, incident.direction, incident.irradiance * visible);
        bits &= bits - 1u;
        if (bits == 0u)
            break;
    }
    return radiance;
}

vec3 reflectedFromWord(ShadingPoint point, uint word, uint bits)
{
    vec3 radiance = vec3(0.0);
    for (; bits != 0u;) {
        radiance += reflectedFrom(point, lights[32u * word + findLSB(bits)]);
        bits &= bits - 1u;
        if (bits == 0u)
            break;
    }
    return radiance;
}

// From the lights of the shader's list and those past its last bit.
vec3 reflectedFromListed(ShadingPoint point)
{
    vec3 radiance = vec3(0.0);
    if ((kFeatures & kFeatureShadows) != 0u)
        radiance = reflectedFromShadowed(point);
    if ((kFeatures & kFeatureUnshadowed) != 0u)
        radiance += reflectedFromWord(point, 0u, listedLights(0u) & ~view.shadowed[0]);
    if ((kFeatures & kFeatureManyLights) != 0u) {
        for (uint word = 1u; word < kListedLights / 32u && 32u * word < view.lightCount; ++word)
            radiance += reflectedFromWord(point, word, listedLights(word) & ~view.shadowed[word]);
        for (uint i = kListedLights; i < view.lightCount; ++i)
            radiance += reflectedFrom(point, lights[i]);
    }
    return radiance;
}

vec3 storable(vec3 radiance)
{
    return min(radiance, vec3(60000.0)); // half float's largest is 65504
}
#endif
