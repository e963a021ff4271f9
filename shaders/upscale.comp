#version 460
#extension GL_GOOGLE_include_directive : require
// Display pass of a frame that was rendered smaller than it is shown: display colours to the wanted size along one
// axis, by Catmull-Rom splines; once for the columns, once for the rows. Upscaled radiance would ring around
// highlights, and cost a tone mapping of every pixel shown.
#include "lib/bicubic.glsl"

layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Constants { ScalePush push; };
layout(set = 1, binding = 0) uniform sampler2D source;
layout(set = 1, binding = 1) uniform writeonly image2D scaled;

// One of the source's texels along the axis that is scaled.
vec3 texelAlong(bool sideways, ivec2 pixel, int place, int from)
{
    place = clamp(place, 0, from - 1);
    return texelFetch(source, sideways ? ivec2(place, pixel.y) : ivec2(pixel.x, place), 0).rgb;
}

vec3 weighted(vec4 w, vec3 a, vec3 b, vec3 c, vec3 d)
{
    return w.x * a + w.y * b + w.z * c + w.w * d;
}

// Four pixels beside each other along that axis: scaled up, but less than three times, they lie between seven texels.
void main()
{
    bool sideways = push.from.x != push.to.x;
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy) * (sideways ? ivec2(4, 1) : ivec2(1, 4));
    if (pixel.x >= push.to.x)
        return;
    int from = int(sideways ? push.from.x : push.from.y), to = int(sideways ? push.to.x : push.to.y);
    int along = sideways ? pixel.x : pixel.y;
    vec4 p = (vec4(along, along + 1, along + 2, along + 3) + 0.5) * float(from) / float(to) - 0.5;
    ivec4 behind = ivec4(floor(p)) - int(floor(p.x)); // of their first texels: 0; 0 or 1; 0 to 2; 1 to 3
    int first = int(floor(p.x)) - 1;
    vec3 t0 = texelAlong(sideways, pixel, first, from), t1 = texelAlong(sideways, pixel, first + 1, from),
         t2 = texelAlong(sideways, pixel, first + 2, from), t3 = texelAlong(sideways, pixel, first + 3, from),
         t4 = texelAlong(sideways, pixel, first + 4, from), t5 = texelAlong(sideways, pixel, first + 5, from),
         t6 = texelAlong(sideways, pixel, first + 6, from);
    mat4 w = transpose(catmullRomWeights(fract(p)));
    vec3 a = weighted(w[0], t0, t1, t2, t3);
    vec3 b = behind.y == 0 ? weighted(w[1], t0, t1, t2, t3) : weighted(w[1], t1, t2, t3, t4);
    vec3 c = behind.z == 0   ? weighted(w[2], t0, t1, t2, t3)
             : behind.z == 1 ? weighted(w[2], t1, t2, t3, t4)
                             : weighted(w[2], t2, t3, t4, t5);
    vec3 d = behind.w == 1   ? weighted(w[3], t1, t2, t3, t4)
             : behind.w == 2 ? weighted(w[3], t2, t3, t4, t5)
                             : weighted(w[3], t3, t4, t5, t6);
    ivec2 next = sideways ? ivec2(1, 0) : ivec2(0, 1);
    imageStore(scaled, pixel, vec4(a, 1.0));
    if (along + 1 < to)
        imageStore(scaled, pixel + next, vec4(b, 1.0));
    if (along + 2 < to)
        imageStore(scaled, pixel + 2 * next, vec4(c, 1.0));
    if (along + 3 < to)
        imageStore(scaled, pixel + 3 * next, vec4(d, 1.0));
}
