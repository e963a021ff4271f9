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

void main()
{
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (pixel.x >= push.to.x)
        return;
    bool sideways = push.from.x != push.to.x;
    uint from = sideways ? push.from.x : push.from.y, to = sideways ? push.to.x : push.to.y;
    float p = (float(sideways ? pixel.x : pixel.y) + 0.5) * float(from) / float(to) - 0.5;
    mat4x2 weights = catmullRomWeights(vec2(fract(p)));
    vec3 sum = vec3(0.0);
    for (int i = 0; i < 4; ++i) {
        int place = clamp(int(floor(p)) + i - 1, 0, int(from) - 1);
        sum += weights[i].x * texelFetch(source, sideways ? ivec2(place, pixel.y) : ivec2(pixel.x, place), 0).rgb;
    }
    imageStore(scaled, pixel, vec4(sum, 1.0));
}
