#version 460
#extension GL_GOOGLE_include_directive : require
// Need pass: what each sample sees. The depth test leaves the nearest surface, so hidden ones are never
// marked by the passes that read this image.
#include "lib/interface.glsl"
#include "lib/footprint.glsl"

layout(push_constant, scalar) uniform Constants { NeedPush push; };
layout(location = 0) in vec2 uv;
// Object and level (kSeen...), uv as unorm16, its derivatives per full-size pixel to the right and down.
layout(location = 0) out uvec4 seen;

void main()
{
    vec2 dx = dFdx(uv) / push.divisor, dy = dFdy(uv) / push.divisor;
    Footprint footprint = footprintOf(dx, dy, vec2(objectAt(push.object).at.litSize), view.anisotropy);
    uint level = uint(clamp(footprint.level - kNeedFinest, 0.0, 15.99) * float(kNeedScale));
    seen = uvec4((push.object + 1u) << kSeenObjectShift | level, packUnorm2x16(uv), packHalf2x16(dx),
                 packHalf2x16(dy));
}
