#version 460
#extension GL_GOOGLE_include_directive : require
// Display pass, to the width that is shown: an invocation makes four pixels of a row, which are one texel.
#include "lib/upscale.glsl"

layout(set = 1, binding = 0) uniform sampler2D source;
layout(set = 1, binding = 1) uniform writeonly uimage2D wide;

int row;
vec3 texel(int x)
{
    return texelFetch(source, ivec2(clamp(x, 0, int(push.from.x) - 1), row), 0).rgb;
}

void main()
{
    ivec2 place = ivec2(gl_GlobalInvocationID.xy);
    if (4 * place.x >= push.to.x)
        return;
    row = place.y;
    Span span = spanOf(4 * place.x, push.from.x, push.to.x);
    int x = span.first;
    Pixels4 p = scaled(span, Texels7(texel(x), texel(x + 1), texel(x + 2), texel(x + 3), texel(x + 4), texel(x + 5),
                                     texel(x + 6)));
    imageStore(wide, place, uvec4(packColour(p.a), packColour(p.b), packColour(p.c), packColour(p.d)));
}
