#version 460
#extension GL_GOOGLE_include_directive : require
// Need pass: what each sample sees. The depth test leaves the nearest surface, so hidden ones are never
// marked by need.comp, which reads this image.
#include "lib/interface.glsl"
#include "lib/footprint.glsl"

layout(push_constant, scalar) uniform Constants { NeedPush push; };
layout(location = 0) in vec2 uv;
layout(location = 0) out uvec2 seen; // object + 1, level in 1 / kNeedScale

void main()
{
    Object object = push.view.at.objects.at[push.object];
    Footprint footprint = footprintOf(dFdx(uv) / push.divisor, dFdy(uv) / push.divisor, vec2(object.litSize),
                                      push.view.at.anisotropy);
    seen = uvec2(push.object + 1u, uint(clamp(footprint.level, 0.0, 30.0) * float(kNeedScale)));
}
