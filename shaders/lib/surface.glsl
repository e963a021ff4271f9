// From a point on a mesh to its radiance: material texels, the tangent frame, the light loop.
// Used per lumel by light.comp and per pixel by forward.frag, so that both light the same way.
#ifndef LUMEL_SURFACE_GLSL
#define LUMEL_SURFACE_GLSL
#include "lib/environment.glsl"
#include "lib/interface.glsl"
#include "lib/shadow.glsl"
#include "shared/shading.h"
#include "shared/tint.h"

layout(set = 1, binding = 0) uniform sampler2D mapNormal;   // N.x N.y S.xx S.yy
layout(set = 1, binding = 1) uniform sampler2D mapSpecular; // Ks S.xy
layout(set = 1, binding = 2) uniform sampler2D mapDiffuse;  // Kd, fit error
layout(set = 1, binding = 3) uniform sampler2D mapEmissive;     // emitted radiance, ambient occlusion
layout(set = 1, binding = 4) uniform sampler2D mapOpacity;  // in x; read by forward.frag only
layout(set = 1, binding = 5) uniform sampler2D mapBase;     // mean F0, mean variance of the level-0 lobes

const bool kConstantEmission = (kFeatures & kFeatureConstantEmission) != 0u;
const bool kConstantBase = (kFeatures & kFeatureConstantBase) != 0u;

struct MaterialTexel {
    vec2 normal;
    vec3 covariance;
    vec3 specular;
    vec3 diffuse;
    vec3 emitted;
    float occlusion;
    vec3 f0; // mean of the level-0 texels
    float baseVariance;
};

MaterialTexel unpackMaterial(vec4 normal, vec4 specular, vec4 diffuse, vec4 emissive, vec4 base)
{
    return MaterialTexel(normal.xy, vec3(normal.z, specular.w, normal.w), specular.rgb, diffuse.rgb, emissive.rgb, emissive.a,
                         base.rgb, base.a);
}

// uv: of the reflectance (xy) and of emissive (zw). levels: of the reflectance and of emissive, which are chains of their own
// sizes: each counts from its own map's finest level. They may be below 0.
MaterialTexel sampleMaterial(vec4 uv, vec2 levels)
{
    levels = max(levels, vec2(0.0));
    // mapBase is of the reflectance's size, or constant.
    return unpackMaterial(
        textureLod(mapNormal, uv.xy, levels.x), textureLod(mapSpecular, uv.xy, levels.x),
        textureLod(mapDiffuse, uv.xy, levels.x),
        kConstantEmission ? texelFetch(mapEmissive, ivec2(0), 0) : textureLod(mapEmissive, uv.zw, levels.y),
        kConstantBase ? texelFetch(mapBase, ivec2(0), 0) : textureLod(mapBase, uv.xy, levels.x));
}

MaterialTexel noMaterial()
{
    return MaterialTexel(vec2(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), 0.0, vec3(0.0), 0.0);
}

// All of it is linear: the maps hold means.
void addMaterial(inout MaterialTexel sum, MaterialTexel texel, float weight)
{
    sum.normal += weight * texel.normal;
    sum.covariance += weight * texel.covariance;
    sum.specular += weight * texel.specular;
    sum.diffuse += weight * texel.diffuse;
    sum.emitted += weight * texel.emitted;
    sum.occlusion += weight * texel.occlusion;
    sum.f0 += weight * texel.f0;
    sum.baseVariance += weight * texel.baseVariance;
}

MaterialTexel tinted(uint flags, float dielectric, MaterialTexel material, vec3 colour)
{
    if (dielectric >= 0.0) {
        vec3 f0 = tintedSpecular(material.f0, material.diffuse, dielectric, colour);
        material.specular *= f0 / max(material.f0, vec3(1e-6));
        material.f0 = f0;
    }
    material.diffuse *= colour;
    if ((flags & kObjectUnlit) != 0u)
        material.emitted *= colour;
    return material;
}

// A point of a surface as the lights see it.
struct ShadingPoint {
    SurfaceReflectance surface;
    vec3 position;
    vec3 toEye;
    vec3 radiance; // emitted, and reflected of what surrounds it
};

// position, normal, tangent (w = handedness) in world space, not necessarily unit.
// flags: of the object.
ShadingPoint shadingPoint(uint flags, MaterialTexel material, vec3 position, vec3 normal, vec4 tangent)
{
    vec3 toEye = normalize(view.eyeInWorld - position);
    vec3 n = normalize(normal);
    bool flip = (flags & kObjectDoubleSided) != 0u && dot(n, toEye) < 0.0;
    vec3 t = tangent.xyz - n * dot(n, tangent.xyz);
    t = dot(t, t) > 1e-12 ? normalize(t) : normalize(abs(n.x) < 0.9 ? cross(n, vec3(1, 0, 0)) : cross(n, vec3(0, 1, 0)));
    // Bitangents belong to the object: a transform that mirrors it mirrors them, but not the cross product.
    bool mirrored = (flags & kObjectMirrored) != 0u;
    vec3 b = cross(n, t) * ((tangent.w < 0.0) != mirrored ? -1.0 : 1.0);
    // Seen from behind, a bump is a dent: it is the map's normal that is reversed, and with it the whole frame.
    n = flip ? -n : n;
    t = flip ? -t : t;
    b = flip ? -b : b;
    // Lumels just behind the silhouette are filtered into pixels before it: they are lit as seen along their
    // horizon, so that no highlight of a surface seen from behind leaks around the edge.
    toEye = normalize(toEye - n * min(dot(n, toEye), 0.0) + 1e-6 * n);

    Lobe local = makeLobe(lobeNormal(material.normal), material.covariance);
    mat3 worldFromTangent = mat3(t, b, n);
    Lobe lobe = Lobe(worldFromTangent * local.normal, worldFromTangent * local.tangentU,
                     worldFromTangent * local.tangentV, local.inverseCovariance, local.scale);
    SurfaceReflectance surface = reflectanceTowards(
        SurfaceTexel(lobe, n, material.specular, material.f0, material.baseVariance, material.diffuse), toEye);
    vec3 around;
    if ((kFeatures & kFeatureEnvironment) != 0u)
        around = surface.diffuse * environmentDiffuse(view.environment, surface.lobe.normal) +
                 reflectEnvironment(surface, toEye);
    else
        around = reflectAmbient(surface, view.skyRadiance, view.groundRadiance);
    return ShadingPoint(surface, position, toEye, material.emitted + around * material.occlusion);
}

vec3 reflectedFrom(ShadingPoint point, Light light)
{
    Incident incident = incidentLight(light, point.position);
    return reflectLight(point.surface, incident.direction, point.toEye, incident.irradiance);
}

// Word `word` of the list of lights that may reach what is shaded, as in JobTile: each shader has its own.
uint listedLights(uint word);
// Bit i: the light of view.shadows[i] is in the list.
uint listedShadows();

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
    for (uint bits = listedShadows(); bits != 0u; bits &= bits - 1u) {
        uint i = findLSB(bits);
        Shadow shadow = view.shadows[i];
        Incident incident = incidentLight(lights[shadow.light], point.position);
        float visible = lightVisibility(shadow, i, point.position, point.surface.macroNormal, incident.direction);
        radiance += reflectLight(point.surface, incident.direction, point.toEye, incident.irradiance * visible);
    }
    return radiance;
}

vec3 reflectedFromWord(ShadingPoint point, uint word, uint bits)
{
    vec3 radiance = vec3(0.0);
    for (; bits != 0u; bits &= bits - 1u)
        radiance += reflectedFrom(point, lights[32u * word + findLSB(bits)]);
    return radiance;
}

// From the lights of the shader's list and those past its last bit.
vec3 reflectedFromListed(ShadingPoint point)
{
    const bool shadows = (kFeatures & kFeatureShadows) != 0u;
    vec3 radiance = vec3(0.0);
    if (shadows)
        radiance = reflectedFromShadowed(point);
    radiance += reflectedFromWord(point, 0u, shadows ? listedLights(0u) & ~view.shadowed[0] : listedLights(0u));
    for (uint word = 1u; word < kListedLights / 32u && 32u * word < view.lightCount; ++word)
        radiance += reflectedFromWord(point, word, shadows ? listedLights(word) & ~view.shadowed[word] : listedLights(word));
    for (uint i = kListedLights; i < view.lightCount; ++i)
        radiance += reflectedFrom(point, lights[i]);
    return radiance;
}

vec3 storable(vec3 radiance)
{
    return min(radiance, vec3(60000.0)); // half float's largest is 65504
}
#endif
