#version 460
#extension GL_GOOGLE_include_directive : require
// Deform pass: where morph targets and joints move the vertices of one mesh. All that follows in the frame reads
// these vertices as it reads those of any other mesh.
#include "lib/interface.glsl"
#include "shared/deform.h"

layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Constants { DeformPush push; };

Vertex deformed(uint index)
{
    Vertex v = push.rest.at[index];
    if (push.morphs != 0u) {
        uint last = push.firstDeltas.at[index + 1u];
        for (uint i = push.firstDeltas.at[index]; i < last; ++i) {
            MorphDelta delta = push.deltas.at[i];
            v = morphed(v, delta, push.weights.at[delta.target]);
        }
    }
    mat4 m = mat4(push.influences == 0u ? 1.0 : 0.0);
    for (uint i = 0u; i < push.influences; ++i) {
        Influence influence = push.joints.at[index * push.influences + i];
        m += influence.weight * push.matrices.at[influence.joint];
    }
    return skinned(v, m);
}

void main()
{
    uint step = gl_NumWorkGroups.x * gl_WorkGroupSize.x;
    for (uint i = gl_GlobalInvocationID.x; i < push.vertexCount; i += step)
        push.deformed.at[i] = deformed(i);
}
