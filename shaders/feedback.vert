#version 460
#extension GL_GOOGLE_include_directive : require
// Feedback pass: any mesh at reduced resolution, shifted by this frame's sub-pixel offset.
#include "lib/interface.glsl"

layout(push_constant, scalar) uniform Constants { FeedbackPush push; };
layout(location = kAttributePosition) in vec3 position;
layout(location = kAttributeUv) in vec2 vertexUv;
layout(location = kAttributeWorld) in mat4 worldFromObject;
layout(location = 0) out vec2 uv;
layout(location = 1) flat out uint object;

void main()
{
    uv = vertexUv;
    object = uint(gl_InstanceIndex);
    gl_Position = view.clipFromWorld * (worldFromObject * vec4(position, 1.0));
    gl_Position.xy += 2.0 * push.jitter / (push.divisor * vec2(push.size)) * gl_Position.w;
}
