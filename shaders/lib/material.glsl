// From a point on a mesh to the surface there: material texels, the tangent frame.
#ifndef LUMEL_MATERIAL_GLSL
#define LUMEL_MATERIAL_GLSL
#include "lib/surface.glsl"
#include "shared/moments.h"
#include "shared/tint.h"

// Of materials of two lobes, the first two are premultiplied as second lobes are, by K + kLeastWeight.
layout(set = 1, binding = 0) uniform sampler2D mapNormal;   // N.x N.y S.xx S.yy
layout(set = 1, binding = 1) uniform sampler2D mapSpecular; // Ks S.xy
layout(set = 1, binding = 2) uniform sampler2D mapDiffuse;  // Kd, fit error
layout(set = 1, binding = 3) uniform sampler2D mapEmissive;     // emitted radiance, ambient occlusion
layout(set = 1, binding = 4) uniform sampler2D mapOpacity;  // in x; read by forward.frag only
layout(set = 1, binding = 5) uniform sampler2D mapBase;     // mean F0, mean variance of the level-0 lobes
// Second lobes from level 1 on, premultiplied by their strength K; k is kSecondCovarianceScale.
layout(set = 1, binding = 6) uniform sampler2D mapSecond;         // K N2.x, K N2.y, k K S2.xx, k K S2.yy
layout(set = 1, binding = 7) uniform sampler2D mapSecondSpecular; // Ks2, k K S2.xy

const bool kConstantEmission = (kFeatures & kFeatureConstantEmission) != 0u;
const bool kConstantBase = (kFeatures & kFeatureConstantBase) != 0u;

// A lobe as texels hold it.
struct LobeTexel {
    vec2 normal;
    vec3 covariance;
    vec3 specular;
};

LobeTexel noLobe()
{
    return LobeTexel(vec2(0.0), vec3(1.0, 0.0, 1.0), vec3(0.0));
}

struct MaterialTexel {
    vec2 normal;
    vec3 covariance;
    vec3 specular;
    vec3 diffuse;
    vec3 emitted;
    float occlusion;
    vec3 f0; // mean of the level-0 texels
    float baseVariance;
    LobeTexel second;
};

// level: of the reflectance.
LobeTexel sampleFirst(vec2 uv, float level)
{
    vec4 normal = textureLod(mapNormal, uv, level), specular = textureLod(mapSpecular, uv, level);
    LobeTexel lobe = LobeTexel(normal.xy, vec3(normal.z, specular.w, normal.w), specular.rgb);
    if (kTwoLobes) {
        float weight = luminanceOf(specular.rgb) + kLeastWeight;
        lobe.normal /= weight;
        lobe.covariance /= kSecondCovarianceScale * weight;
    }
    return lobe;
}

LobeTexel sampleSecond(vec2 uv, float level)
{
    vec4 moments = textureLod(mapSecond, uv, max(level - 1.0, 0.0));
    vec4 specular = textureLod(mapSecondSpecular, uv, max(level - 1.0, 0.0));
    float strength = lobeStrength(specular.rgb);
    // Where there is none, as wide a lobe as can be: it is as good as any, and harmless.
    vec3 covariance = vec3(moments.z, specular.w, moments.w) / kSecondCovarianceScale + 1e-6 * vec3(1.0, 0.0, 1.0);
    return LobeTexel(moments.xy / strength, covariance / strength, specular.rgb);
}

// A share of level 0's lobe and one of level 1, at a level between them.
LobeTexel mixLobes(LobeTexel finest, float share, LobeTexel coarser, float level)
{
    vec3 fine = (1.0 - level) * share * finest.specular, coarse = level * coarser.specular;
    float strength = level * lobeStrength(coarser.specular);
    float t = strength / (strength + (1.0 - level) * share * lobeStrength(finest.specular));
    return LobeTexel(mix(finest.normal, coarser.normal, t), mix(finest.covariance, coarser.covariance, t), fine + coarse);
}

struct LobePair {
    LobeTexel first, second;
};
LobePair sampleLobes(vec2 uv, float level)
{
    if (!kTwoLobes)
        return LobePair(sampleFirst(uv, level), noLobe());
    // Level 0 has one lobe. Blended with level 1 it counts as two, in the shares that they have there: were it the first
    // alone, that would turn towards the first of level 1 while the second has not come up.
    LobePair pair = LobePair(sampleFirst(uv, max(level, 1.0)), sampleSecond(uv, max(level, 1.0)));
    if (level < 1.0) {
        LobeTexel finest = sampleFirst(uv, 0.0);
        float first = lobeStrength(pair.first.specular), second = lobeStrength(pair.second.specular);
        pair.first = mixLobes(finest, first / (first + second), pair.first, level);
        pair.second = mixLobes(finest, second / (first + second), pair.second, level);
    }
    return pair;
}

// uv: of the reflectance (xy) and of emissive (zw). levels: of the reflectance and of emissive, which are chains of their own
// sizes: each counts from its own map's finest level. They may be below 0.
MaterialTexel sampleMaterial(vec4 uv, vec2 levels)
{
    levels = max(levels, vec2(0.0));
    // mapBase is of the reflectance's size, or constant.
    LobePair lobes = sampleLobes(uv.xy, levels.x);
    vec3 diffuse = textureLod(mapDiffuse, uv.xy, levels.x).rgb;
    vec4 emissive = kConstantEmission ? texelFetch(mapEmissive, ivec2(0), 0) : textureLod(mapEmissive, uv.zw, levels.y);
    vec4 base = kConstantBase ? texelFetch(mapBase, ivec2(0), 0) : textureLod(mapBase, uv.xy, levels.x);
    return MaterialTexel(lobes.first.normal, lobes.first.covariance, lobes.first.specular, diffuse, emissive.rgb, emissive.a,
                         base.rgb, base.a, lobes.second);
}

MaterialTexel noMaterial()
{
    return MaterialTexel(vec2(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), 0.0, vec3(0.0), 0.0, noLobe());
}

// All of it is linear: the maps hold means. Not so lobes: see moments.h.
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
    sum.second.specular += weight * texel.second.specular;
}

MaterialTexel tinted(uint flags, float dielectric, MaterialTexel material, vec3 colour)
{
    if (dielectric >= 0.0) {
        vec3 f0 = tintedSpecular(material.f0, material.diffuse, dielectric, colour);
        material.specular *= f0 / max(material.f0, vec3(1e-6));
        material.second.specular *= f0 / max(material.f0, vec3(1e-6));
        material.f0 = f0;
    }
    material.diffuse *= colour;
    if ((flags & kObjectUnlit) != 0u)
        material.emitted *= colour;
    return material;
}

Lobe rotated(mat3 rotation, Lobe lobe)
{
    return Lobe(rotation * lobe.normal, rotation * lobe.tangentU, rotation * lobe.tangentV, lobe.inverseCovariance,
                lobe.scale);
}

// In world space.
SecondSurfaceLobe secondLobe(MaterialTexel material, mat3 worldFromTangent)
{
    LobeTexel second = material.second;
    return SecondSurfaceLobe(rotated(worldFromTangent, makeLobe(lobeNormal(second.normal), second.covariance)),
                             second.specular);
}

// position, normal, tangent (w = handedness) in world space, not necessarily unit.
// flags: of the object.
SurfacePoint surfacePoint(uint flags, MaterialTexel material, vec3 position, vec3 normal, vec4 tangent)
{
    vec3 n = normalize(normal);
    vec3 t = tangent.xyz - n * dot(n, tangent.xyz);
    t = dot(t, t) > 1e-12 ? normalize(t) : normalize(abs(n.x) < 0.9 ? cross(n, vec3(1, 0, 0)) : cross(n, vec3(0, 1, 0)));
    // Bitangents belong to the object: a transform that mirrors it mirrors them, but not the cross product.
    bool mirrored = (flags & kObjectMirrored) != 0u;
    vec3 b = cross(n, t) * ((tangent.w < 0.0) != mirrored ? -1.0 : 1.0);
    mat3 worldFromTangent = mat3(t, b, n);
    Lobe lobe = rotated(worldFromTangent, makeLobe(lobeNormal(material.normal), material.covariance));
    return SurfacePoint(SurfaceTexel(lobe, n, material.specular, material.f0, material.baseVariance, material.diffuse),
                        position, material.emitted, material.occlusion, secondLobe(material, worldFromTangent));
}
#endif
