#version 460
#extension GL_GOOGLE_include_directive : require
// Feedback pass: what an alpha mask cuts out hides nothing. Opacity is read as forward.frag reads it: at the pixel's
// own footprint, whatever the sample's block of pixels.
#include "lib/footprint.glsl"
#include "lib/sample.glsl"
#include "lib/material.glsl"

layout(push_constant, scalar) uniform Constants { FeedbackPush push; };
layout(location = 0) in vec2 uv;
layout(location = 1) in vec2 materialUv;
layout(location = 2) in float tintOpacity;
layout(location = 0) out uvec4 seen;

// A sample for a block of pixels looks at some of its neighbours too (in pixels, a rotated grid) and sees through
// if any of them does: finely cut leaves would else hide what their holes show until the cycle of offsets meets
// one. Marking hidden surface behind costs lighting it; missing visible surface draws it too coarse.
const vec2 kNeighbours[4] = vec2[](vec2(-1.0, -2.0), vec2(2.0, -1.0), vec2(1.0, 2.0), vec2(-2.0, 1.0));

void main()
{
    vec2 dx = dFdx(materialUv) / push.divisor, dy = dFdy(materialUv) / push.divisor;
    uvec4 found = sampleHere(push.object, uv, push.divisor, push.jitter); // derivatives before any fragment ends
    float level = max(levelOf(mapOpacity, dx, dy, 1.0), 0.0);
    float opacity = textureLod(mapOpacity, materialUv, level).x;
    for (int i = 0; i < (push.divisor > 1.0 ? 4 : 0); ++i) {
        vec2 beside = materialUv + kNeighbours[i].x * dx + kNeighbours[i].y * dy;
        opacity = min(opacity, textureLod(mapOpacity, beside, level).x);
    }
    if (kColoured)
        opacity *= tintOpacity;
    if (opacity < objectAt(push.object).at.alphaCutoff)
        discard;
    seen = found;
}
