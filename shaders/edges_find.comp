#version 460
#extension GL_GOOGLE_include_directive : require
// Edge filter, first step: lists the pixels beside whose borders another object begins. An invocation looks at a block
// of pixels and the frame around it, so that few are read more than once.
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

// The numbers of a block's row, and of the pixels beside it.
struct Row {
    vec4 own;
    float left, right;
};
vec4 rowAt(ivec2 first)
{
    return vec4(numberAt(first), numberAt(first + ivec2(1, 0)), numberAt(first + ivec2(2, 0)),
                numberAt(first + ivec2(3, 0)));
}

// One bit for each pixel of the block, row after row.
uint edgesOf(ivec2 first)
{
    uint edges = 0u;
    vec4 above = rowAt(first - ivec2(0, 1)), own = rowAt(first);
    for (int y = 0;;) {
        ivec2 row = first + ivec2(0, y);
        vec4 below = rowAt(row + ivec2(0, 1));
        vec4 left = vec4(numberAt(row - ivec2(1, 0)), own.xyz), right = vec4(own.yzw, numberAt(row + ivec2(4, 0)));
        vec4 differs = abs(above - own) + abs(below - own) + abs(left - own) + abs(right - own);
        uvec4 bits = mix(uvec4(0u), uvec4(1u, 2u, 4u, 8u), greaterThan(differs, vec4(0.0)));
        edges |= (bits.x | bits.y | bits.z | bits.w) << uint(4 * y);
        above = own;
        own = below;
        if (++y == int(kEdgeBlock.y))
            return edges;
    }
}

void main()
{
    ivec2 first = ivec2(gl_GlobalInvocationID.xy * kEdgeBlock);
    if (first.x >= push.size.x)
        return;
    // Loops end with their tests: software Vulkan would run a body once more to find the test on its top.
    for (uint edges = edgesOf(first);;) {
        uint i = uint(findLSB(edges));
        ivec2 pixel = first + ivec2(i & 3u, i >> 2u);
        if (edges != 0u && all(lessThan(pixel, push.size)))
            append(pixel);
        edges &= edges - 1u;
        if (edges == 0u)
            break;
    }
}
