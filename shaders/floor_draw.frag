#version 460
#extension GL_GOOGLE_include_directive : require
// Floor of drawing in texture space: any mesh with a ready texture of its own density, no choice of level or taps.
#include "lib/bicubic.glsl"

layout(constant_id = 1) const uint kLookups = kFloorBilinear;
layout(push_constant, scalar) uniform Constants { FloorPush push; };
layout(set = 1, binding = 0) uniform sampler2DArray lit; // repeats; layer 1 is the coarser level
layout(location = 3) in vec2 uv;
layout(location = 0) out vec4 colour;

// As the draw pass filters by default.
vec3 bicubic(vec2 size, float layer)
{
    Kernel kernel = catmullRomKernel(uv * size);
    vec4 sum = vec4(0.0);
    for (int i = 0;;) {
        Lookup lookup = catmullRom(kernel, i);
        sum += lookup.weight * vec4(textureLod(lit, vec3(lookup.place / float(kFloorSide), layer), 0.0).rgb, 1.0);
        if (++i >= kFilterLookups[kFilterCatmullRom])
            break;
    }
    return sum.rgb / sum.a;
}

void main()
{
    vec3 radiance;
    if (kLookups == kFloorBilinear)
        radiance = textureLod(lit, vec3(uv * vec2(push.size) / float(kFloorSide), 0.0), 0.0).rgb;
    else
        radiance = bicubic(vec2(push.size), 0.0);
    if (kLookups == kFloorTwoLevels)
        radiance = mix(radiance, bicubic(0.5 * vec2(push.size), 1.0), 0.5);
    colour = vec4(max(radiance, vec3(0.0)), 1.0);
}
