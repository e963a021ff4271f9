#version 460
#extension GL_GOOGLE_include_directive : require
// Any mesh for drawing: world-space position, normal and tangent for the fragment shader.
#include "lib/geometry.glsl"

layout(push_constant, scalar) uniform Constants { DrawPush push; };
layout(location = 0) out vec3 positionInWorld;
layout(location = 1) out vec3 normalInWorld;
layout(location = 2) out vec4 tangentInWorld;
layout(location = 3) out vec2 uv;
layout(location = 4) out vec4 materialUv; // of the reflectance (xy) and of glow (zw)
layout(location = 5) out vec4 tint;

void main()
{
    ObjectAt object = objectAt(push.object);
    Vertex vertex = object.at.vertices.at[gl_VertexIndex];
    vec4 world = object.at.worldFromObject * vec4(vertex.position, 1.0);
    positionInWorld = world.xyz;
    normalInWorld = object.at.worldFromObjectNormal * vertex.normal;
    tangentInWorld = vec4(mat3(object.at.worldFromObject) * vertex.tangent.xyz, vertex.tangent.w);
    uv = vertex.uv;
    materialUv = vec4(vertex.materialUv, vertex.glowUv);
    if (kColoured)
        tint = vertexColour(object, gl_VertexIndex);
    gl_Position = view.clipFromWorld * world;
}
