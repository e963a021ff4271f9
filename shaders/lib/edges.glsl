// Edges between objects, by the number that the draw pass writes into alpha.
#ifndef LUMEL_EDGES_GLSL
#define LUMEL_EDGES_GLSL
#include "lib/interface.glsl"
#include "shared/tonemap.h"

layout(buffer_reference, scalar, buffer_reference_align = 4) buffer EdgeLists { EdgeList at; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer EdgePixels { EdgePixel at[]; };

layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Constants { EdgePush push; };
layout(set = 1, binding = 0) uniform sampler2D radiance;
layout(set = 1, binding = 2) uniform writeonly image2D display;
const uint kToneMap = kFeatures; // kToneMap..., as in display.comp

// Beyond the border lies what is at it.
vec4 radianceAt(ivec2 pixel)
{
    return texelFetch(radiance, clamp(pixel, ivec2(0), ivec2(push.size) - 1), 0);
}

vec4 displayed(vec3 radiance)
{
    return vec4(displayColour(radiance, view.exposure, kToneMap), 1.0);
}

// What blends over a background leaves less than 1 there.
float numberAt(ivec2 pixel)
{
    return floor(radianceAt(pixel).a);
}
#endif
