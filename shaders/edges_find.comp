#version 460
#extension GL_GOOGLE_include_directive : require
// Edge filter, first step: lists the pixels beside whose borders another object begins. An invocation looks at 2x2.
#include "lib/edges.glsl"

void append(ivec2 pixel)
{
    uint slot = atomicAdd(push.list.at.count, 1u);
    if (slot >= push.capacity)
        return; // stays as it is
    push.pixels.at[slot].place = uint(pixel.y) << 16u | uint(pixel.x);
    if (slot % 64u == 0u)
        atomicAdd(push.list.at.groups[0], 1u);
}

void main()
{
    ivec2 corner = 2 * ivec2(gl_GlobalInvocationID.xy);
    if (corner.x >= push.size.x)
        return;
    for (int i = 0; i < 4; ++i) {
        ivec2 pixel = corner + ivec2(i & 1, i >> 1);
        float own = numberAt(pixel);
        bool differs = numberAt(pixel - ivec2(1, 0)) != own || numberAt(pixel + ivec2(1, 0)) != own ||
                       numberAt(pixel - ivec2(0, 1)) != own || numberAt(pixel + ivec2(0, 1)) != own;
        if (differs && all(lessThan(pixel, push.size)))
            append(pixel);
    }
}
