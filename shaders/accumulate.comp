#version 460
#extension GL_GOOGLE_include_directive : require
// Reference: adds one shifted frame to the sum, in linear light and single precision.
#include "lib/interface.glsl"

layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Constants { DisplayPush push; };
layout(set = 1, binding = 0, rgba16f) uniform readonly image2D frame;
layout(set = 1, binding = 1, rgba32f) uniform image2D sum;

void main()
{
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (pixel.x >= view.sizePixels.x)
        return;
    imageStore(sum, pixel, imageLoad(sum, pixel) + imageLoad(frame, pixel));
}
