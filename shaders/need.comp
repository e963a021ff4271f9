#version 460
#extension GL_GOOGLE_include_directive : require
// Need pass, second half: the finest level that any sample of each object needs.
#include "lib/interface.glsl"

layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Constants { NeedPush push; };
layout(set = 1, binding = 0, rgba32ui) uniform readonly uimage2D seen;

void main()
{
    uint index = gl_GlobalInvocationID.x;
    if (index >= push.size.x * push.size.y)
        return;
    uvec4 sample4 = imageLoad(seen, ivec2(index % push.size.x, index / push.size.x));
    uint sight = sample4.x;
    if (sight == 0u)
        return;
    uint object = (sight >> kSeenObjectShift) - 1u;
    uint level = sight & kSeenLevelMask;
    // Reading first spares most atomics: after a few samples the least level hardly changes.
    if (level < push.needs.at[object].level)
        atomicMin(push.needs.at[object].level, level);
    atomicAdd(push.needs.at[object].samples, 1u);
    // The pixel's parallelogram in lumels of its level: 1 where it is square, more along a long footprint.
    vec2 dx = unpackHalf2x16(sample4.z), dy = unpackHalf2x16(sample4.w), size = vec2(objectAt(object).at.litSize);
    float area = abs(dx.x * dy.y - dx.y * dy.x) * size.x * size.y;
    float lumels = area * exp2(-2.0 * max(float(level) / float(kNeedScale) + kNeedFinest, 0.0));
    atomicAdd(push.needs.at[object].lumels, uint(min(lumels, 64.0) * float(kNeedScale)));
}
