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
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy * uvec2(1u, kDisplayRows));
    if (pixel.x >= push.size.x)
        return;
    // Loops end with their tests: software Vulkan would run a body once more to find the test on its top.
    for (int end = min(pixel.y + int(kDisplayRows), int(push.size.y));;) {
        vec3 linear = texelFetch(radiance, pixel, 0).rgb * push.weight;
        imageStore(display, pixel, vec4(displayColour(linear, view.exposure, kToneMap), 1.0));
        if (++pixel.y >= end)
            break;
    }
}
