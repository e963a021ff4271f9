#version 460
#extension GL_GOOGLE_include_directive : require
// Any mesh as a light sees it.
#include "lib/geometry.glsl"

layout(push_constant, scalar) uniform Constants { ShadowPush push; };
layout(location = 0) out vec2 materialUv;
layout(location = 1) out float tintOpacity;

void main()
{
    ObjectAt object = objectAt(push.object);
    Vertex vertex = object.at.vertices.at[gl_VertexIndex];
    materialUv = vertex.materialUv;
    if (kColoured)
        tintOpacity = vertexColour(object, gl_VertexIndex).a;
    gl_Position = push.clipFromWorld * (object.at.worldFromObject * vec4(vertex.position, 1.0));
}
