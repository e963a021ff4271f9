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
const int kFilterLookups[5] = int[](1, 4, 5, 16, 3); // by kFilter...

// What the lookups around a point have in common: where they lie along each axis, and how much they weigh.
struct Kernel {
    vec2 low, middle, high; // lumels
    vec2 lowWeight, middleWeight, highWeight;
};

// Uniform cubic B-spline with 4 lookups: Sigg and Hadwiger 2005, "Fast Third-Order Texture Filtering" (GPU Gems 2,
// chapter 20). Smooth (C2), slightly blurs; never overshoots.
Kernel bsplineKernel(vec2 p)
{
    vec2 f = fract(p - 0.5);
    vec2 f2 = f * f, f3 = f2 * f;
    vec2 w0 = (1.0 - 3.0 * f + 3.0 * f2 - f3) / 6.0;
    vec2 w1 = (4.0 - 6.0 * f2 + 3.0 * f3) / 6.0;
    vec2 w3 = f3 / 6.0;
    vec2 g0 = w0 + w1, g1 = 1.0 - g0;
    vec2 low = floor(p - 0.5) - 0.5 + w1 / g0, high = floor(p - 0.5) + 1.5 + w3 / g1;
    return Kernel(low, p, high, g0, vec2(0.0), g1);
}

Lookup bspline(Kernel kernel, int i)
{
    bvec2 isHigh = bvec2((i & 1) != 0, (i & 2) != 0);
    vec2 w = mix(kernel.lowWeight, kernel.highWeight, isHigh);
    return Lookup(mix(kernel.low, kernel.high, isHigh), w.x * w.y);
}

// Weights of the four lumels around f in [0, 1): Catmull and Rom 1974, "A Class of Local Interpolating Splines".
mat4x2 catmullRomWeights(vec2 f)
{
    return mat4x2(f * (-0.5 + f * (1.0 - 0.5 * f)), 1.0 + f * f * (-2.5 + 1.5 * f), f * (0.5 + f * (2.0 - 1.5 * f)),
                  f * f * (-0.5 + 0.5 * f));
}

// The same of four places: a column each weight, a row each place.
mat4 catmullRomWeights(vec4 f)
{
    return mat4(f * (-0.5 + f * (1.0 - 0.5 * f)), 1.0 + f * f * (-2.5 + 1.5 * f), f * (0.5 + f * (2.0 - 1.5 * f)),
                f * f * (-0.5 + 0.5 * f));
}

// Catmull-Rom with 5 lookups: the 9 of its separable form less the four corners, whose weights are small,
// renormalised (Jimenez 2016, "Filmic SMAA"). Interpolates: keeps contrast. Its two lumels in the middle are one.
Kernel catmullRomKernel(vec2 p)
{
    vec2 centre = floor(p - 0.5) + 0.5;
    mat4x2 w = catmullRomWeights(p - centre);
    vec2 w12 = w[1] + w[2];
    return Kernel(centre - 1.0, centre + w[2] / w12, centre + 2.0, w[0], w12, w[3]);
}

// The middle, then left, right, above and below it.
Lookup catmullRom(Kernel kernel, int i)
{
    bool low = (i & 1) != 0;
    vec2 far = low ? kernel.low : kernel.high, farWeight = low ? kernel.lowWeight : kernel.highWeight;
    bvec2 isFar = bvec2(i == 1 || i == 2, i > 2);
    vec2 w = mix(kernel.middleWeight, farWeight, isFar);
    return Lookup(mix(kernel.middle, far, isFar), w.x * w.y);
}

// The same spline with its 16 lumels: what the 5 lookups are measured against.
Lookup catmullRomExact(vec2 p, int i)
{
    vec2 centre = floor(p - 0.5) + 0.5;
    mat4x2 w = catmullRomWeights(p - centre);
    int x = i & 3, y = i >> 2;
    return Lookup(centre + vec2(x - 1, y - 1), w[x].x * w[y].y);
}

// Interpolating quadratics with 3 lookups (Dodgson 1997, "Quadratic Interpolation for Image Resampling", r = 1): of the
// three lumels around the nearest along each axis, one weighs less than 0, or nothing. As above the corners are left
// out. As sharp as Catmull-Rom, and nearer to the reference.
Kernel quadraticKernel(vec2 p)
{
    vec2 nearest = floor(p) + 0.5, t = p - nearest, side = mix(vec2(1.0), vec2(-1.0), lessThan(t, vec2(0.0)));
    vec2 f = abs(t); // in [0, 0.5]
    vec2 farWeight = f * (f - 0.5), nearWeight = f * (f + 0.5);
    vec2 middleWeight = 1.0 - farWeight;
    vec2 middle = nearest + side * nearWeight / middleWeight, far = nearest - side;
    return Kernel(far, middle, far, farWeight, middleWeight, farWeight);
}

// The middle, then the lumels that weigh less than 0 beside it and above or below it.
Lookup quadratic(Kernel kernel, int i)
{
    bvec2 isFar = bvec2(i == 1, i == 2);
    vec2 w = mix(kernel.middleWeight, kernel.lowWeight, isFar);
    return Lookup(mix(kernel.middle, kernel.low, isFar), w.x * w.y);
}

// The kernel around p in lumels, and its lookup i < kFilterLookups[kind]. kind is a specialisation constant: software
// Vulkan runs both sides of any other branch.
Kernel kernelOf(uint kind, vec2 p)
{
    if (kind == kFilterBspline)
        return bsplineKernel(p);
    if (kind == kFilterCatmullRom)
        return catmullRomKernel(p);
    if (kind == kFilterQuadratic)
        return quadraticKernel(p);
    return Kernel(p, p, p, vec2(1.0), vec2(1.0), vec2(1.0));
}

Lookup lookupOf(uint kind, Kernel kernel, int i)
{
    if (kind == kFilterBspline)
        return bspline(kernel, i);
    if (kind == kFilterCatmullRom)
        return catmullRom(kernel, i);
    if (kind == kFilterQuadratic)
        return quadratic(kernel, i);
    if (kind == kFilterCatmullRomExact)
        return catmullRomExact(kernel.middle, i);
    return Lookup(kernel.middle, 1.0);
}
#endif
