#version 460
#extension GL_GOOGLE_include_directive : require
// Edge filter, first step: shows all pixels as they are, and lists those beside whose borders another object begins. An
// invocation looks at a block of pixels and the frame around it, so that few are read more than once.
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

// A row of the block: radiance, and in alpha what edges are told by.
struct Row {
    vec4 a, b, c, d;
};
Row rowAt(ivec2 first)
{
    return Row(radianceAt(first), radianceAt(first + ivec2(1, 0)), radianceAt(first + ivec2(2, 0)),
               radianceAt(first + ivec2(3, 0)));
}
vec4 numbersOf(Row row)
{
    return floor(vec4(row.a.a, row.b.a, row.c.a, row.d.a));
}

void show(ivec2 pixel, vec4 radiance)
{
    if (all(lessThan(pixel, push.size)))
        imageStore(display, pixel, displayed(radiance.rgb));
}

// Shows the block. One bit for each pixel of it that is at an edge, row after row.
uint edgesOf(ivec2 first)
{
    uint edges = 0u;
    Row row = rowAt(first);
    vec4 above = numbersOf(rowAt(first - ivec2(0, 1))), own = numbersOf(row);
    for (int y = 0;;) {
        ivec2 pixel = first + ivec2(0, y);
        show(pixel, row.a);
        show(pixel + ivec2(1, 0), row.b);
        show(pixel + ivec2(2, 0), row.c);
        show(pixel + ivec2(3, 0), row.d);
        row = rowAt(pixel + ivec2(0, 1));
        vec4 below = numbersOf(row);
        vec4 left = vec4(numberAt(pixel - ivec2(1, 0)), own.xyz), right = vec4(own.yzw, numberAt(pixel + ivec2(4, 0)));
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
