#version 460
#extension GL_GOOGLE_include_directive : require
// Two triangles over a rectangle of the picture, for one texture of the pool.
#include "lib/interface.glsl"

layout(push_constant, scalar) uniform Constants { PoolPush push; };
layout(location = 0) out vec2 place;

void main()
{
    uint corner = gl_VertexIndex < 3 ? gl_VertexIndex : 6u - gl_VertexIndex; // 0 1 2, 3 2 1
    place = vec2(corner & 1u, corner >> 1u);
    gl_Position = vec4(push.rectangle.xy + place * push.rectangle.zw, 1.0, 1.0);
}
