// Filters for drawing the lit texture: lookups in one MIP of it.
#ifndef LUMEL_BICUBIC_GLSL
#define LUMEL_BICUBIC_GLSL
#include "lib/footprint.glsl"
#include "lib/interface.glsl"

// One MIP of a lit texture: a rectangle of a pool block's layer, whose borders no tap may cross.
struct LitMip {
    vec2 size;   // lumels
    vec2 origin; // lumels
    vec2 inverseBlock; // 1 / lumels of the block
    float layer;
};

// p: in lumels of the MIP. a: how much of it holds light; lumels that wait for theirs are 0 in all channels.
vec4 tap(sampler2DArray lit, LitMip mip, vec2 p)
{
    vec2 inside = mip.origin + clamp(p, vec2(0.5), mip.size - 0.5);
    return textureLod(lit, vec3(inside * mip.inverseBlock, mip.layer), 0.0);
}

// A filter as bilinear lookups: where in the MIP, and how much each weighs; together they weigh about 1.
struct Lookup {
    vec2 place; // lumels
    float weight;
};
const int kFilterLookups[4] = int[](1, 4, 5, 16); // by kFilter...

// Uniform cubic B-spline with 4 lookups: Sigg and Hadwiger 2005, "Fast Third-Order Texture Filtering" (GPU Gems 2,
// chapter 20). Smooth (C2), slightly blurs; never overshoots.
Lookup bspline(vec2 p, int i)
{
    vec2 f = fract(p - 0.5);
    vec2 f2 = f * f, f3 = f2 * f;
    vec2 w0 = (1.0 - 3.0 * f + 3.0 * f2 - f3) / 6.0;
    vec2 w1 = (4.0 - 6.0 * f2 + 3.0 * f3) / 6.0;
    vec2 w3 = f3 / 6.0;
    vec2 g0 = w0 + w1, g1 = 1.0 - g0;
    vec2 low = floor(p - 0.5) - 0.5 + w1 / g0, high = floor(p - 0.5) + 1.5 + w3 / g1;
    bvec2 isHigh = bvec2((i & 1) != 0, (i & 2) != 0);
    vec2 w = mix(g0, g1, isHigh);
    return Lookup(mix(low, high, isHigh), w.x * w.y);
}

// Weights of the four lumels around f in [0, 1): Catmull and Rom 1974, "A Class of Local Interpolating Splines".
mat4x2 catmullRomWeights(vec2 f)
{
    return mat4x2(f * (-0.5 + f * (1.0 - 0.5 * f)), 1.0 + f * f * (-2.5 + 1.5 * f), f * (0.5 + f * (2.0 - 1.5 * f)),
                  f * f * (-0.5 + 0.5 * f));
}

// Catmull-Rom with 5 lookups: the 9 of its separable form less the four corners, whose weights are small,
// renormalised (Jimenez 2016, "Filmic SMAA"). Interpolates: keeps contrast.
Lookup catmullRom(vec2 p, int i)
{
    vec2 centre = floor(p - 0.5) + 0.5;
    mat4x2 w = catmullRomWeights(p - centre);
    vec2 w12 = w[1] + w[2];
    vec2 middle = centre + w[2] / w12;
    // The middle, then left, right, above and below it.
    bool sideways = i == 1 || i == 2;
    vec2 far = (i & 1) != 0 ? centre - 1.0 : centre + 2.0;
    vec2 farWeight = (i & 1) != 0 ? w[0] : w[3];
    if (i == 0)
        return Lookup(middle, w12.x * w12.y);
    return sideways ? Lookup(vec2(far.x, middle.y), farWeight.x * w12.y)
                    : Lookup(vec2(middle.x, far.y), w12.x * farWeight.y);
}

// The same spline with its 16 lumels: what the 5 lookups are measured against.
Lookup catmullRomExact(vec2 p, int i)
{
    vec2 centre = floor(p - 0.5) + 0.5;
    mat4x2 w = catmullRomWeights(p - centre);
    int x = i & 3, y = i >> 2;
    return Lookup(centre + vec2(x - 1, y - 1), w[x].x * w[y].y);
}

// Lookup i < kFilterLookups[kind] around p in lumels. kind is a specialisation constant: software Vulkan runs both
// sides of any other branch.
Lookup lookupOf(uint kind, vec2 p, int i)
{
    if (kind == kFilterBspline)
        return bspline(p, i);
    if (kind == kFilterCatmullRom)
        return catmullRom(p, i);
    if (kind == kFilterCatmullRomExact)
        return catmullRomExact(p, i);
    return Lookup(p, 1.0);
}
#endif
