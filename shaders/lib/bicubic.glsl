// Filters for drawing the lit texture: one level, then two levels blended, then along the footprint.
#ifndef LUMEL_BICUBIC_GLSL
#define LUMEL_BICUBIC_GLSL
#include "lib/footprint.glsl"

// Uniform cubic B-spline with 4 bilinear taps: Sigg and Hadwiger 2005, "Fast Third-Order Texture Filtering"
// (GPU Gems 2, chapter 20). Smooth (C2), slightly blurs; never overshoots.
vec3 sampleBspline(sampler2DArray lit, vec2 uv, float layer, float level, vec2 size)
{
    vec2 p = uv * size - 0.5;
    vec2 f = fract(p);
    vec2 base = floor(p);
    vec2 f2 = f * f, f3 = f2 * f;
    vec2 w0 = (1.0 - 3.0 * f + 3.0 * f2 - f3) / 6.0;
    vec2 w1 = (4.0 - 6.0 * f2 + 3.0 * f3) / 6.0;
    vec2 w3 = f3 / 6.0;
    vec2 w2 = 1.0 - w0 - w1 - w3;
    vec2 g0 = w0 + w1, g1 = w2 + w3;
    vec2 h0 = (base - 0.5 + w1 / g0) / size;
    vec2 h1 = (base + 1.5 + w3 / g1) / size;
    return g0.y * (g0.x * textureLod(lit, vec3(h0.x, h0.y, layer), level).rgb +
                   g1.x * textureLod(lit, vec3(h1.x, h0.y, layer), level).rgb) +
           g1.y * (g0.x * textureLod(lit, vec3(h0.x, h1.y, layer), level).rgb +
                   g1.x * textureLod(lit, vec3(h1.x, h1.y, layer), level).rgb);
}

// Catmull-Rom (Catmull and Rom 1974) with 5 bilinear taps: the 9 taps of its separable form less the four
// corners, whose weights are small, renormalised (Jimenez 2016, "Filmic SMAA"). Interpolates: keeps contrast;
// clamped below at 0, since its lobes overshoot.
vec3 sampleCatmullRom(sampler2DArray lit, vec2 uv, float layer, float level, vec2 size)
{
    vec2 p = uv * size;
    vec2 centre = floor(p - 0.5) + 0.5;
    vec2 f = p - centre;
    vec2 w0 = f * (-0.5 + f * (1.0 - 0.5 * f));
    vec2 w1 = 1.0 + f * f * (-2.5 + 1.5 * f);
    vec2 w2 = f * (0.5 + f * (2.0 - 1.5 * f));
    vec2 w3 = f * f * (-0.5 + 0.5 * f);
    vec2 w12 = w1 + w2;
    vec2 t0 = (centre - 1.0) / size;
    vec2 t12 = (centre + w2 / w12) / size;
    vec2 t3 = (centre + 2.0) / size;
    vec4 sum = vec4(textureLod(lit, vec3(t12.x, t0.y, layer), level).rgb, 1.0) * (w12.x * w0.y);
    sum += vec4(textureLod(lit, vec3(t0.x, t12.y, layer), level).rgb, 1.0) * (w0.x * w12.y);
    sum += vec4(textureLod(lit, vec3(t12.x, t12.y, layer), level).rgb, 1.0) * (w12.x * w12.y);
    sum += vec4(textureLod(lit, vec3(t3.x, t12.y, layer), level).rgb, 1.0) * (w3.x * w12.y);
    sum += vec4(textureLod(lit, vec3(t12.x, t3.y, layer), level).rgb, 1.0) * (w12.x * w3.y);
    return max(sum.rgb / sum.a, vec3(0.0));
}

vec3 sampleLevel(sampler2DArray lit, uint kind, vec2 uv, float layer, float level)
{
    if (kind == kFilterBilinear)
        return textureLod(lit, vec3(uv, layer), level).rgb;
    vec2 size = vec2(textureSize(lit, int(level)).xy);
    return kind == kFilterBspline ? sampleBspline(lit, uv, layer, level, size)
                                  : sampleCatmullRom(lit, uv, layer, level, size);
}

vec3 sampleLevels(sampler2DArray lit, uint kind, vec2 uv, float layer, float level)
{
    float fine = floor(level);
    vec3 colour = sampleLevel(lit, kind, uv, layer, fine);
    if (level - fine > 1.0 / 64.0)
        colour = mix(colour, sampleLevel(lit, kind, uv, layer, fine + 1.0), level - fine);
    return colour;
}

// level: of the lit texture's own MIP chain, >= 0.
vec3 sampleLit(sampler2DArray lit, uint kind, vec2 uv, float layer, float level, Footprint footprint)
{
    if (footprint.taps == 1)
        return sampleLevels(lit, kind, uv, layer, level);
    vec3 sum = vec3(0.0);
    for (int i = 0; i < footprint.taps; ++i) {
        float t = (2.0 * float(i) + 1.0) / float(footprint.taps) - 1.0;
        sum += sampleLevels(lit, kind, uv + t * footprint.axis, layer, level);
    }
    return sum / float(footprint.taps);
}
#endif
