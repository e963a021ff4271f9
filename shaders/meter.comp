#version 460
#extension GL_GOOGLE_include_directive : require
// Meter: a histogram of the luminances in the picture. A group counts a strip 64 pixels wide.
#include "lib/interface.glsl"
#include "shared/meter.h"

layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Constants { MeterPush push; };
layout(set = 1, binding = 0) uniform sampler2D radiance; // alpha: the share of a pixel that anything covers

shared uint bins[kMeterBins];

void main()
{
    uint local = gl_LocalInvocationIndex;
    for (uint i = local; i < kMeterBins; i += 64u)
        bins[i] = 0u;
    barrier();
    uint x = gl_GlobalInvocationID.x, first = gl_WorkGroupID.y * kMeterRows;
    for (uint y = first; y < min(first + kMeterRows, push.size.y); ++y) {
        vec4 pixel = texelFetch(radiance, ivec2(min(x, push.size.x - 1u), y), 0);
        if (x < push.size.x && pixel.a >= 0.5)
            atomicAdd(bins[meterBin(luminanceOf(pixel.rgb))], 1u);
    }
    barrier();
    for (uint i = local; i < kMeterBins; i += 64u)
        if (bins[i] > 0u)
            atomicAdd(push.histogram.at[i], bins[i]);
}
