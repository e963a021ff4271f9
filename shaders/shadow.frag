#version 460
#extension GL_GOOGLE_include_directive : require
// What alpha cuts out of a surface casts no shadow.
#include "lib/footprint.glsl"
#include "lib/material.glsl"

layout(push_constant, scalar) uniform Constants { ShadowPush push; };
layout(location = 0) in vec2 materialUv;
layout(location = 1) in float tintOpacity;

void main()
{
    float level = levelOf(mapOpacity, dFdx(materialUv), dFdy(materialUv), 1.0);
    float opacity = textureLod(mapOpacity, materialUv, max(level, 0.0)).x;
    if (kColoured)
        opacity *= tintOpacity;
    if (opacity < objectAt(push.object).at.alphaCutoff)
        discard;
}
