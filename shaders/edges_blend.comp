#version 460
#extension GL_GOOGLE_include_directive : require
// Edge filter, second step: how much of a listed pixel would other objects cover, were the staircase between them the
// line that it stands for? That line runs from the middle of one step to the middle of the next (Reshetov 2009,
// "Morphological Antialiasing"). Steps are told by objects, not by colours: nothing on a surface is blurred.
#include "lib/edges.glsl"

const int kReach = 6; // pixels to either side that a step is looked for; farther ones gained nothing
// Tuned on the stress scene and the record against 64 samples: steps are only guesses at the line.
const float kConfidence = 0.8;

// From a pixel along an edge, to where it ends: distance in pixels, and whether it goes on one row inwards. Where it
// turns for more than a row there is a corner, which stays.
struct End {
    float distance;
    bool inwards;
};
End endOf(ivec2 pixel, ivec2 outwards, ivec2 along, float own)
{
    for (int i = 1;; ++i) {
        ivec2 next = pixel + i * along;
        bool inwards = numberAt(next) != own, ends = inwards || numberAt(next + outwards) == own;
        if (ends || i == kReach)
            return End(float(ends ? i - 1 : i), inwards && numberAt(next - outwards) == own);
    }
}

// Area between the edge and a line that falls from half a pixel at 0 to none at half of `edge`, up to x.
float areaTo(float x, float edge)
{
    x = min(x, 0.5 * edge);
    return 0.5 * (x - x * x / edge);
}

ivec2 outwardsTo(int side)
{
    return (side & 1) == 0 ? ivec2(side - 1, 0) : ivec2(0, side - 2);
}

float coverageBy(ivec2 pixel, ivec2 outwards, float own)
{
    ivec2 along = abs(outwards.yx);
    End a = endOf(pixel, outwards, along, own), b = endOf(pixel, outwards, -along, own);
    float edge = a.distance + b.distance + 1.0;
    return (a.inwards ? areaTo(a.distance + 1.0, edge) - areaTo(a.distance, edge) : 0.0) +
           (b.inwards ? areaTo(b.distance + 1.0, edge) - areaTo(b.distance, edge) : 0.0);
}

void main()
{
    uint index = gl_GlobalInvocationID.x;
    if (index >= min(push.list.at.count, push.capacity))
        return;
    uint place = push.pixels.at[index].place;
    ivec2 pixel = ivec2(place & 0xffffu, place >> 16u);
    vec4 own = radianceAt(pixel);
    vec4 others = vec4(0.0);
    float coverage = 0.0;
    uint sides = 0u; // where others are
    for (int i = 0; i < 4; ++i) {
        vec4 beside = radianceAt(pixel + outwardsTo(i));
        bool differs = floor(beside.a) != floor(own.a);
        others += differs ? vec4(beside.rgb, 1.0) : vec4(0.0);
        sides |= differs ? 1u << uint(i) : 0u;
    }
    // A listed pixel has at least one, and most have no more: software Vulkan would go the way along all four.
    do {
        coverage = max(coverage, coverageBy(pixel, outwardsTo(findLSB(sides)), floor(own.a)));
        sides &= sides - 1u;
    } while (sides != 0u);
    vec3 blended = mix(own.rgb, others.rgb / max(others.a, 1.0), kConfidence * coverage);
    push.pixels.at[index].radiance = uvec2(packHalf2x16(blended.rg), packHalf2x16(vec2(blended.b, own.a)));
}
