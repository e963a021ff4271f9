#version 460
#extension GL_GOOGLE_include_directive : require
// Any mesh that is shaded per pixel: world-space position, normal and tangent for the fragment shader.
#include "lib/geometry.glsl"

layout(push_constant, scalar) uniform Constants { DrawPush push; };
layout(location = kAttributePosition) in vec3 position;
layout(location = kAttributeNormal) in vec3 normal;
layout(location = kAttributeTangent) in vec4 tangent;
layout(location = kAttributeUv) in vec2 vertexUv;
layout(location = kAttributeMaterialUv) in vec4 vertexMaterialUv;
layout(location = kAttributeWorld) in mat4 worldFromObject;
layout(location = kAttributeWorldNormal) in mat3 worldFromObjectNormal;
layout(location = 0) out vec3 positionInWorld;
layout(location = 1) out vec3 normalInWorld;
layout(location = 2) out vec4 tangentInWorld;
layout(location = 3) out vec2 uv;
layout(location = 4) out vec4 materialUv; // of the reflectance (xy) and of emissive (zw)
layout(location = 5) out vec4 tint;
invariant gl_Position;

void main()
{
    vec4 world = worldFromObject * vec4(position, 1.0);
    positionInWorld = world.xyz;
    normalInWorld = worldFromObjectNormal * normal;
    tangentInWorld = vec4(mat3(worldFromObject) * tangent.xyz, tangent.w);
    uv = vertexUv;
    materialUv = vertexMaterialUv;
    if (kColoured)
        tint = vertexColour(objectAt(push.object), gl_VertexIndex);
    gl_Position = view.clipFromWorld * world;
}
