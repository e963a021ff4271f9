#version 460
#extension GL_GOOGLE_include_directive : require
// Any mesh as a light sees it.
#include "lib/geometry.glsl"

layout(push_constant, scalar) uniform Constants { ShadowPush push; };
layout(location = kAttributePosition) in vec3 position;
layout(location = kAttributeMaterialUv) in vec4 vertexMaterialUv;
layout(location = kAttributeWorld) in mat4 worldFromObject;
layout(location = 0) out vec2 materialUv;
layout(location = 1) out float tintOpacity;

void main()
{
    materialUv = vertexMaterialUv.xy;
    if (kColoured)
        tintOpacity = vertexColour(objectAt(push.object), gl_VertexIndex).a;
    gl_Position = push.clipFromWorld * (worldFromObject * vec4(position, 1.0));
}
