#version 460
#extension GL_GOOGLE_include_directive : require
// Display pass: the only place where radiance becomes display colour.
#include "lib/interface.glsl"
#include "shared/tonemap.h"

layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Constants { DisplayPush push; };
layout(set = 1, binding = 0) uniform sampler2D radiance; // half or single precision
const uint kToneMap = kFeatures; // kToneMap...: its pipelines differ in nothing else
layout(set = 1, binding = 1) uniform writeonly image2D display;

void main()
{
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (pixel.x >= push.size.x)
        return;
    vec3 linear = texelFetch(radiance, pixel, 0).rgb * push.weight;
    imageStore(display, pixel, vec4(displayColour(linear, view.exposure, kToneMap), 1.0));
}
