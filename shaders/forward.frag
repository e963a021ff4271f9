#version 460
#extension GL_GOOGLE_include_directive : require
// Forward shading: the same BRDF and the same fitted MIPs, evaluated per pixel. With the level fixed to 0 and
// many shifted frames averaged it is the reference.
#include "lib/footprint.glsl"
#include "lib/material.glsl"

layout(push_constant, scalar) uniform Constants { ForwardPush push; };
layout(location = 0) in vec3 positionInWorld;
layout(location = 1) in vec3 normalInWorld;
layout(location = 2) in vec4 tangentInWorld;
layout(location = 4) in vec4 uv; // of the reflectance (xy) and of emissive (zw)
layout(location = 5) in vec4 tint;
layout(location = 0) out vec4 colour;
layout(constant_id = 2) const uint kAnisotropy = 1u; // most taps along a footprint's major axis

// Taps of an anisotropic lookup lie at even distances along the footprint's major axis, on the level of its minor one:
// where tap i of n lies, from -1 to 1. Not the sampler's own anisotropy: how many taps that takes, and where, is each
// device's choice, and it is an optional feature.
float alongAxis(int i, int n)
{
    return (2.0 * float(i) + 1.0) / float(n) - 1.0;
}

Footprint footprintIn(sampler2D map, vec2 dx, vec2 dy)
{
    return footprintOf(dx, dy, vec2(textureSize(map, 0)), float(kAnisotropy));
}

// The lobes of several taps: one, or two of which each takes those that are nearer to it, whichever they were of theirs.
struct TapLobes {
    LobeMoments first, second;
    LobeMoments means; // of each tap's lobes
    vec3 secondSpecular;
};

TapLobes noLobes()
{
    return TapLobes(noMoments(), noMoments(), noMoments(), vec3(0.0));
}

float distance2(LobeMoments lobes, vec2 normal)
{
    vec2 d = momentNormal(lobes) - normal;
    return dot(d, d);
}

void addLobe(inout TapLobes sum, LobeTexel lobe, bool isSecond)
{
    float strength = lobeStrength(lobe.specular), other = isSecond ? 1.0 : 0.0;
    sum.first = plusLobe(sum.first, strength * (1.0 - other), lobe.normal, lobe.covariance);
    sum.second = plusLobe(sum.second, strength * other, lobe.normal, lobe.covariance);
    sum.secondSpecular += other * lobe.specular;
}

// Between level 0, where both lobes are one, and level 1 surfaces bend from the one to the other: the variance of that.
vec3 bendBetween(LobeTexel first, LobeTexel second, float share, float level)
{
    float fine = level < 1.0 ? 1.0 / max(level, 1e-3) - 1.0 : 0.0;
    vec2 d = second.normal - first.normal;
    return fine * share * (1.0 - share) * vec3(d.x * d.x, d.x * d.y, d.y * d.y);
}

void addLobes(inout TapLobes sum, MaterialTexel texel, float level)
{
    LobeTexel first = LobeTexel(texel.normal, texel.covariance, texel.specular), second = texel.second;
    float strength = lobeStrength(first.specular);
    if (!kTwoLobes) {
        sum.first = plusLobe(sum.first, strength, first.normal, first.covariance);
        return;
    }
    float both = strength + lobeStrength(second.specular), share = lobeStrength(second.specular) / both;
    vec3 bend = bendBetween(first, second, share, level);
    first.covariance += bend;
    second.covariance += bend;
    bool isFirstTap = sum.means.strength == 0.0;
    bool firstToSecond = !isFirstTap && distance2(sum.second, first.normal) < distance2(sum.first, first.normal);
    bool secondToSecond = isFirstTap || distance2(sum.second, second.normal) < distance2(sum.first, second.normal);
    addLobe(sum, first, firstToSecond);
    addLobe(sum, second, secondToSecond);
    sum.means = plusLobe(sum.means, both, mix(first.normal, second.normal, share), vec3(0.0));
}

// sum: the means of all taps, whose lobes are to be found.
void takeLobes(inout MaterialTexel sum, TapLobes lobes, float taps)
{
    sum.normal = momentNormal(lobes.first);
    if (!kTwoLobes) {
        sum.covariance = momentCovariance(lobes.first, tapSpread(taps));
        return;
    }
    // What the normal varies within a tap's part, as far as it varies between them: both lobes have it.
    vec3 within = (tapSpread(taps) - 1.0) * momentCovariance(lobes.means, 1.0);
    vec3 second = lobes.secondSpecular / taps;
    sum.covariance = momentCovariance(lobes.first, 1.0) + within;
    sum.specular += sum.second.specular - second;
    sum.second = LobeTexel(momentNormal(lobes.second), momentCovariance(lobes.second, 1.0) + within, second);
}

MaterialTexel materialHere(vec4 dx, vec4 dy)
{
    if (push.draw.level >= 0.0)
        return sampleMaterial(uv, vec2(push.draw.level));
    if (kAnisotropy == 1u)
        return sampleMaterial(uv, vec2(levelOf(mapNormal, dx.xy, dy.xy, 1.0),
                                       kConstantEmission ? 0.0 : levelOf(mapEmissive, dx.zw, dy.zw, 1.0)));
    Footprint reflectance = footprintIn(mapNormal, dx.xy, dy.xy), emissive = footprintIn(mapEmissive, dx.zw, dy.zw);
    int taps = reflectanceTaps(max(reflectance.elongation, emissive.elongation));
    MaterialTexel sum = noMaterial();
    TapLobes lobes = noLobes();
    for (int i = 0; i < taps; ++i) {
        MaterialTexel texel = sampleMaterial(uv + alongAxis(i, taps) * vec4(reflectance.axis, emissive.axis),
                                             vec2(reflectance.level, emissive.level));
        addMaterial(sum, texel, 1.0 / float(taps));
        addLobes(lobes, texel, reflectance.level);
    }
    takeLobes(sum, lobes, float(taps));
    return sum;
}

// Texels of level 0 hold no slope, as those of coarser levels do: a pixel as large as one sees its normal turn within it,
// and is as wide as that makes it. The variance over a pixel is a twelfth of its difference squared. (Kaplanyan et al.
// 2016, "Filtering Distributions of Normals for Shading Antialiasing", take it from screen derivatives too.)
vec3 slopeWithinPixel(vec2 normal, vec4 dx, vec4 dy)
{
    vec2 alongX = dFdx(normal), alongY = dFdy(normal);
    if (push.draw.level >= 0.0)
        return vec3(0.0); // many samples make a pixel
    Footprint footprint = footprintIn(mapNormal, dx.xy, dy.xy);
    bool manyTaps = kAnisotropy != 1u && reflectanceTaps(footprint.elongation) > 1; // they have seen the slope
    float share = manyTaps ? 0.0 : clamp(1.0 - footprint.level, 0.0, 1.0);
    return share / 12.0 * (alongX.xxy * alongX.xyy + alongY.xxy * alongY.xyy);
}

float opacityHere(vec4 dx, vec4 dy)
{
    if ((kFeatures & kFeatureConstantOpacity) != 0u)
        return texelFetch(mapOpacity, ivec2(0), 0).x;
    if (push.draw.level >= 0.0 || kAnisotropy == 1u) {
        float level = push.draw.level >= 0.0 ? push.draw.level : levelOf(mapOpacity, dx.xy, dy.xy, 1.0);
        return textureLod(mapOpacity, uv.xy, max(level, 0.0)).x;
    }
    Footprint footprint = footprintIn(mapOpacity, dx.xy, dy.xy);
    int taps = reflectanceTaps(footprint.elongation);
    float sum = 0.0;
    for (int i = 0; i < taps; ++i)
        sum += textureLod(mapOpacity, uv.xy + alongAxis(i, taps) * footprint.axis, max(footprint.level, 0.0)).x;
    return sum / float(taps);
}

uint listedLights(uint word)
{
    return push.lights[word];
}

uint listedShadows()
{
    return shadowsAmongListed();
}

float listedVisibility(uint shadow, ShadingPoint point, vec3 toLight)
{
    return lightVisibility(view.shadows[shadow], shadow, point.position, point.surface.macroNormal, toLight);
}

void main()
{
    vec4 dx = dFdx(uv), dy = dFdy(uv);
    float opacity = opacityHere(dx, dy);
    if (kColoured)
        opacity *= tint.a;
    if ((push.flags & kObjectMask) != 0u && opacity < push.alphaCutoff)
        discard;
    MaterialTexel material = materialHere(dx, dy);
    vec3 slope = slopeWithinPixel(material.normal, dx, dy);
    material.covariance += slope;
    material.second.covariance += slope;
    if (kColoured)
        material = tinted(push.flags, push.dielectric, material, max(tint.rgb, vec3(0.0)));
    ShadingPoint point = shadingPoint(
        push.flags, surfacePoint(push.flags, material, positionInWorld, normalInWorld, tangentInWorld));
    vec3 radiance = point.radiance + reflectedFromListed(point);
    // What blends has an opacity, what does not may have a number.
    colour = vec4(storable(radiance), push.draw.opacity > 1.0 ? push.draw.opacity : opacity * push.draw.opacity);
}
