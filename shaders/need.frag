#version 460
#extension GL_GOOGLE_include_directive : require
// Need pass: what each sample sees. The depth test leaves the nearest surface, so hidden ones are never
// marked by the passes that read this image.
#include "lib/interface.glsl"

layout(push_constant, scalar) uniform Constants { NeedPush push; };
layout(location = 0) in vec2 uv;
// Object + 1, uv as unorm16, its derivatives per full-size pixel to the right and down.
layout(location = 0) out uvec4 seen;

void main()
{
    seen = uvec4(push.object + 1u, packUnorm2x16(uv), packHalf2x16(dFdx(uv) / push.divisor),
                 packHalf2x16(dFdy(uv) / push.divisor));
}
