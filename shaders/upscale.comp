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

// Two pixels beside each other along that axis: scaled up, they share three of the four texels that each reads, or all.
void main()
{
    bool sideways = push.from.x != push.to.x;
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy) * (sideways ? ivec2(2, 1) : ivec2(1, 2));
    if (pixel.x >= push.to.x)
        return;
    int from = int(sideways ? push.from.x : push.from.y), to = int(sideways ? push.to.x : push.to.y);
    int along = sideways ? pixel.x : pixel.y;
    vec2 p = (vec2(along, along + 1) + 0.5) * float(from) / float(to) - 0.5;
    int first = int(floor(p.x)) - 1;
    bool next = int(floor(p.y)) - 1 != first; // the second's first texel
    vec3 t0 = texelAlong(sideways, pixel, first, from), t1 = texelAlong(sideways, pixel, first + 1, from),
         t2 = texelAlong(sideways, pixel, first + 2, from), t3 = texelAlong(sideways, pixel, first + 3, from),
         t4 = texelAlong(sideways, pixel, first + 4, from);
    mat4x2 weights = catmullRomWeights(fract(p)); // of both
    vec3 a = weights[0].x * t0 + weights[1].x * t1 + weights[2].x * t2 + weights[3].x * t3;
    vec3 b = next ? weights[0].y * t1 + weights[1].y * t2 + weights[2].y * t3 + weights[3].y * t4
                  : weights[0].y * t0 + weights[1].y * t1 + weights[2].y * t2 + weights[3].y * t3;
    imageStore(scaled, pixel, vec4(a, 1.0));
    if (along + 1 < to)
        imageStore(scaled, pixel + (sideways ? ivec2(1, 0) : ivec2(0, 1)), vec4(b, 1.0));
}
