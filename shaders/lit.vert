#version 460
#extension GL_GOOGLE_include_directive : require
// A mesh that draws its lit texture: where, and which lumels. Positions are surface.vert's to the last bit, since
// what fades in over it is drawn where depths are equal.
#include "lib/interface.glsl"

layout(location = kAttributePosition) in vec3 position;
layout(location = kAttributeUv) in vec2 vertexUv;
layout(location = kAttributeWorld) in mat4 worldFromObject;
layout(location = 3) out vec2 uv;
invariant gl_Position;

void main()
{
    uv = vertexUv;
    vec4 world = worldFromObject * vec4(position, 1.0);
    gl_Position = view.clipFromWorld * world;
}
