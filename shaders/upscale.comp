#version 460
#extension GL_GOOGLE_include_directive : require
// Display pass of a frame that was rendered smaller than it is shown: bicubic, then radiance to display colour.
#include "lib/bicubic.glsl"
#include "shared/tonemap.h"

layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Constants { DisplayPush push; };
layout(set = 1, binding = 0) uniform sampler2D radiance;
layout(set = 1, binding = 1, rgba8) uniform writeonly image2D display;

void main()
{
    uvec2 size = view.sizePixels;
    uint index = gl_GlobalInvocationID.x;
    if (index >= size.x * size.y)
        return;
    ivec2 pixel = ivec2(index % size.x, index / size.x);
    vec2 p = (vec2(pixel) + 0.5) * vec2(push.size) / vec2(size);
    vec2 inverseWhole = 1.0 / vec2(textureSize(radiance, 0));
    vec4 sum = vec4(0.0);
    for (int i = 0; i < kFilterLookups[kFilterCatmullRom]; ++i) {
        Lookup lookup = catmullRom(p, i);
        vec2 inside = clamp(lookup.place, vec2(0.5), vec2(push.size) - 0.5); // the rest is of other frames
        sum += lookup.weight * vec4(textureLod(radiance, inside * inverseWhole, 0.0).rgb, 1.0);
    }
    vec3 linear = max(sum.rgb / sum.a, vec3(0.0)) * push.weight; // Catmull-Rom's lobes may fall below 0
    imageStore(display, pixel, vec4(displayColour(linear, view.exposure, push.toneMap), 1.0));
}
