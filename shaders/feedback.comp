#version 460
#extension GL_GOOGLE_include_directive : require
// Feedback pass, second half: the finest level that any sample of each object needs, and how long footprints are.
#include "lib/footprint.glsl"
#include "lib/lit_object.glsl"
#include "lib/rows.glsl"

layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Constants { FeedbackPush push; };
layout(set = 1, binding = 0, rgba32ui) uniform readonly uimage2D seen;

// One longer than FeedbackTotal's: glslang would give a workgroup's variable the array's explicit layout
// (VUID-StandaloneSpirv-None-10684).
shared uint elongations[kElongations + 1u];

void count(uvec4 seenBy)
{
    uint index = seenBy.x - 1u;
    LitObject object = litObject(index);
    vec2 dx = unpackHalf2x16(seenBy.z), dy = unpackHalf2x16(seenBy.w), size = vec2(object.litSize);
    uint level = uint(clamp(footprintOf(dx, dy, size, view.anisotropy).level - kFeedbackFinest, 0.0, 15.99) * float(kFeedbackScale));
    // Reading first spares most atomics: after a few samples the least level hardly changes.
    if (level < push.objects.at[index].level)
        atomicMin(push.objects.at[index].level, level);
    atomicAdd(push.objects.at[index].samples, 1u);
    if ((objectFlags(object) & kObjectLightable) == 0u)
        return;
    // The pixel's elliptical footprint in lumels; level 0 is the finest.
    float area = abs(dx.x * dy.y - dx.y * dy.x) * size.x * size.y;
    float minor = exp2(footprintOf(dx, dy, size, 1e4).level);
    float major = area / minor;
    float longer = max(major, 1.0) / max(minor, 1.0), share = min(major, 1.0) * min(minor, 1.0);
    uint bin = min(uint(float(kElongationsPerOctave) * log2(longer)), kElongations - 1u);
    atomicAdd(elongations[bin], uint(share * float(kFeedbackScale)));
}

void main()
{
    uint local = gl_LocalInvocationIndex;
    if (local < kElongations)
        elongations[local] = 0u;
    barrier();
    uint index = listIndex();
    if (index < push.size.x * push.size.y) {
        uvec4 seenBy = imageLoad(seen, ivec2(index % push.size.x, index / push.size.x));
        if (seenBy.x != 0u)
            count(seenBy);
    }
    barrier();
    if (local < kElongations && elongations[local] > 0u) {
        uint before = atomicAdd(push.total.at.elongations[local], elongations[local]);
        if (before + elongations[local] < before)
            atomicAdd(push.total.at.carries[local], 1u);
    }
}
