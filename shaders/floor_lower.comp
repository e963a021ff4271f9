#version 460
#extension GL_GOOGLE_include_directive : require
// Floor of deriving coarser lumels: the mean of 2 x 2.
#include "lib/interface.glsl"
#include "lib/rows.glsl"

layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Constants { FloorPush push; };
layout(set = 1, binding = 2, rgba16f) uniform image2DArray lit;

void main()
{
    uint index = listIndex();
    if (index >= push.lumels)
        return;
    ivec2 lumel = ivec2(index % (kFloorSide / 2u), index / (kFloorSide / 2u)), first = 2 * lumel;
    vec4 sum = vec4(0.0);
    for (int i = 0; i < 4; ++i)
        sum += imageLoad(lit, ivec3(first + ivec2(i & 1, i >> 1), 0));
    imageStore(lit, ivec3(lumel, 1), 0.25 * sum);
}
