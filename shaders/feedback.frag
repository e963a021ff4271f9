#version 460
#extension GL_GOOGLE_include_directive : require
// Feedback pass: what each sample sees. The depth test leaves the nearest surface, so hidden ones are never
// marked by the passes that read this image.
#include "lib/interface.glsl"
#include "lib/sample.glsl"

layout(push_constant, scalar) uniform Constants { FeedbackPush push; };
layout(location = 0) in vec2 uv;
layout(location = 1) flat in uint object;
layout(location = 0) out uvec4 seen;

void main()
{
    seen = sampleHere(object, uv, push.divisor, push.jitter);
}
