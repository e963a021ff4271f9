#version 460
#extension GL_GOOGLE_include_directive : require
// A lit texture with its MIPs beside it, as it lies in the pool.
#include "lib/interface.glsl"

layout(push_constant, scalar) uniform Constants { PoolPush push; };
layout(set = 1, binding = 1) uniform sampler2DArray lit;
layout(location = 0) in vec2 place;
layout(location = 0) out vec4 colour;

void main()
{
    // Never lit: a dark blue that no lit surface has.
    vec4 held = textureLod(lit, vec3(place, push.layer), 0.0);
    colour = vec4(push.shade * (held.a > 0.0 ? held.rgb : vec3(0.01, 0.015, 0.04)), 1.0);
}
