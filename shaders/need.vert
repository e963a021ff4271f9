#version 460
#extension GL_GOOGLE_include_directive : require
// Need pass: any mesh at reduced resolution, shifted by this frame's sub-pixel offset.
#include "lib/geometry.glsl"

layout(push_constant, scalar) uniform Constants { NeedPush push; };
layout(location = 0) out vec2 uv;

void main()
{
    ObjectAt object = objectAt(push.object);
    Vertex vertex = object.at.vertices.at[gl_VertexIndex];
    uv = vertex.uv;
    gl_Position = view.clipFromWorld * (object.at.worldFromObject * vec4(vertex.position, 1.0));
    gl_Position.xy += push.jitter * gl_Position.w;
}
