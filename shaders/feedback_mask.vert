#version 460
#extension GL_GOOGLE_include_directive : require
// Feedback pass: a mesh whose material has an alpha mask, placed as feedback.vert does.
#include "lib/geometry.glsl"

layout(push_constant, scalar) uniform Constants { FeedbackPush push; };
layout(location = kAttributePosition) in vec3 position;
layout(location = kAttributeUv) in vec2 vertexUv;
layout(location = kAttributeMaterialUv) in vec4 vertexMaterialUv;
layout(location = kAttributeWorld) in mat4 worldFromObject;
layout(location = 0) out vec2 uv;
layout(location = 1) out vec2 materialUv;
layout(location = 2) out float tintOpacity;

void main()
{
    uv = vertexUv;
    materialUv = vertexMaterialUv.xy;
    if (kColoured)
        tintOpacity = vertexColour(objectAt(push.object), gl_VertexIndex).a;
    gl_Position = view.clipFromWorld * (worldFromObject * vec4(position, 1.0));
    gl_Position.xy += 2.0 * push.jitter / (push.divisor * vec2(push.size)) * gl_Position.w;
}
