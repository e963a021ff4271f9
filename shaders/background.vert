#version 460
#extension GL_GOOGLE_include_directive : require
// A triangle over the whole picture, at infinity.
#include "lib/interface.glsl"

layout(location = 0) out vec4 farInWorld; // homogeneous

void main()
{
    vec2 corner = vec2(gl_VertexIndex == 1 ? 3.0 : -1.0, gl_VertexIndex == 2 ? 3.0 : -1.0);
    gl_Position = vec4(corner, 0.0, 1.0);
    farInWorld = view.worldFromClip * vec4(corner, 0.0, 1.0);
}
