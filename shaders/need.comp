#version 460
#extension GL_GOOGLE_include_directive : require
// Need pass, second half: each visible sample marks its object's finest level.
#include "lib/interface.glsl"

layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Constants { NeedPush push; };
layout(set = 0, binding = 0, rg32ui) uniform readonly uimage2D seen;

void main()
{
    uint index = gl_GlobalInvocationID.x;
    if (index >= push.size.x * push.size.y)
        return;
    uvec2 sight = imageLoad(seen, ivec2(index % push.size.x, index / push.size.x)).xy;
    if (sight.x == 0u)
        return;
    uint object = sight.x - 1u;
    // Reading first spares most atomics: after a few samples the least level hardly changes.
    if (sight.y < push.needs.at[object].level)
        atomicMin(push.needs.at[object].level, sight.y);
    atomicAdd(push.needs.at[object].samples, 1u);
}
