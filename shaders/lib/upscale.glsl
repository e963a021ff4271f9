// The display pass of a frame that was rendered smaller than it is shown scales display colours to the wanted size by
// Catmull-Rom splines: to its width (upscale_x.comp), then to its height (upscale_y.comp). Upscaled radiance would ring
// around highlights, and cost a tone mapping of every pixel shown.
#ifndef LUMEL_UPSCALE_GLSL
#define LUMEL_UPSCALE_GLSL
#include "lib/bicubic.glsl"

layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Constants { ScalePush push; };

// Four pixels beside each other along an axis, scaled up, but less than three times: they lie between seven texels.
struct Span {
    int first;   // of the seven texels
    ivec4 behind; // of it, the first that each pixel reads: 0; 0 or 1; 0 to 2; 1 to 3
    mat4 weights; // a column each pixel
};
Span spanOf(int pixel, uint from, uint to)
{
    vec4 p = (vec4(pixel, pixel + 1, pixel + 2, pixel + 3) + 0.5) * float(from) / float(to) - 0.5;
    int first = int(floor(p.x));
    return Span(first - 1, ivec4(floor(p)) - first, transpose(catmullRomWeights(fract(p))));
}

struct Texels7 {
    vec3 t0, t1, t2, t3, t4, t5, t6;
};
struct Pixels4 {
    vec3 a, b, c, d;
};

vec3 weighted(vec4 w, vec3 a, vec3 b, vec3 c, vec3 d)
{
    return w.x * a + w.y * b + w.z * c + w.w * d;
}

Pixels4 scaled(Span span, Texels7 t)
{
    mat4 w = span.weights;
    ivec4 behind = span.behind;
    vec3 a = weighted(w[0], t.t0, t.t1, t.t2, t.t3);
    vec3 b = behind.y == 0 ? weighted(w[1], t.t0, t.t1, t.t2, t.t3) : weighted(w[1], t.t1, t.t2, t.t3, t.t4);
    vec3 c = behind.z == 0   ? weighted(w[2], t.t0, t.t1, t.t2, t.t3)
             : behind.z == 1 ? weighted(w[2], t.t1, t.t2, t.t3, t.t4)
                             : weighted(w[2], t.t2, t.t3, t.t4, t.t5);
    vec3 d = behind.w == 1   ? weighted(w[3], t.t1, t.t2, t.t3, t.t4)
             : behind.w == 2 ? weighted(w[3], t.t2, t.t3, t.t4, t.t5)
                             : weighted(w[3], t.t3, t.t4, t.t5, t.t6);
    return Pixels4(a, b, c, d);
}

// Between the two steps four pixels of a row are one texel, a word each: on software Vulkan a lookup of four costs as
// much as of one. 11, 11 and 10 bits: a sixth of an 8-bit step, of blue a third. The splines overshoot by an eighth.
const vec3 kMost = vec3(2047.0, 2047.0, 1023.0), kUnit = kMost / 1.25, kZero = 0.125 * kUnit;

uint packColour(vec3 colour)
{
    ivec3 q = ivec3(clamp(colour * kUnit + kZero, vec3(0.0), kMost) + 0.5);
    return uint(q.r | q.g << 11 | q.b << 22);
}

// In the packed numbers' units, of which weights that sum to 1 leave any mean: see unpacked().
vec3 packedNumbers(uint word)
{
    return vec3(ivec3(word & 0x7ffu, word >> 11u & 0x7ffu, word >> 22u));
}

vec3 unpacked(vec3 numbers)
{
    return (numbers - kZero) / kUnit;
}
#endif
