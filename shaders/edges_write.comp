#version 460
#extension GL_GOOGLE_include_directive : require
// Edge filter, last step: the listed pixels, once no other reads them any more.
#include "lib/edges.glsl"

layout(set = 1, binding = 1, rgba16f) uniform writeonly image2D written;

void main()
{
    uint index = gl_GlobalInvocationID.x;
    if (index >= min(push.list.at.count, push.capacity))
        return;
    uint place = push.pixels.at[index].place;
    uvec2 packed = push.pixels.at[index].radiance;
    ivec2 pixel = ivec2(place & 0xffffu, place >> 16u);
    vec4 blended = vec4(unpackHalf2x16(packed.x), unpackHalf2x16(packed.y));
    imageStore(written, pixel, blended);
    imageStore(display, pixel, displayed(blended.rgb));
}
