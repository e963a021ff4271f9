#version 460
#extension GL_GOOGLE_include_directive : require
// Draw pass: an object in texture space is its lit texture, filtered. No light is evaluated here.
#include "lib/interface.glsl"
#include "lib/bicubic.glsl"

layout(push_constant, scalar) uniform Constants { DrawPush push; };
layout(set = 0, binding = 0) uniform sampler2DArray lit;
layout(location = 3) in vec2 uv;
layout(location = 0) out vec4 colour;

void main()
{
    Object object = push.view.at.objects.at[push.object];
    Footprint footprint = footprintOf(dFdx(uv), dFdy(uv), vec2(object.litSize), push.view.at.anisotropy);
    float level = clamp(footprint.level - float(object.litLevel), 0.0, float(textureQueryLevels(lit) - 1));
    colour = vec4(sampleLit(lit, push.filterKind, uv, float(object.layer), level, footprint), 1.0);
}
