#version 460
#extension GL_GOOGLE_include_directive : require
// Display pass, to the height that is shown: an invocation makes four pixels of each of four columns.
#include "lib/upscale.glsl"

layout(set = 1, binding = 0) uniform usampler2D wide;
layout(set = 1, binding = 1) uniform writeonly image2D display;

uvec4 texelsAt(int x, int y)
{
    return texelFetch(wide, ivec2(x, clamp(y, 0, int(push.from.y) - 1)), 0);
}

void show(ivec2 pixel, vec3 numbers)
{
    if (all(lessThan(pixel, push.to)))
        imageStore(display, pixel, vec4(unpacked(numbers), 1.0));
}

void main()
{
    ivec2 place = ivec2(gl_GlobalInvocationID.xy), pixel = 4 * place;
    if (pixel.x >= push.to.x)
        return;
    Span span = spanOf(pixel.y, push.from.y, push.to.y);
    int y = span.first;
    uvec4 t0 = texelsAt(place.x, y), t1 = texelsAt(place.x, y + 1), t2 = texelsAt(place.x, y + 2),
          t3 = texelsAt(place.x, y + 3), t4 = texelsAt(place.x, y + 4), t5 = texelsAt(place.x, y + 5),
          t6 = texelsAt(place.x, y + 6);
    for (int i = 0;;) { // of the columns
        Pixels4 p = scaled(span, Texels7(packedNumbers(t0.x), packedNumbers(t1.x), packedNumbers(t2.x),
                                         packedNumbers(t3.x), packedNumbers(t4.x), packedNumbers(t5.x),
                                         packedNumbers(t6.x)));
        show(pixel, p.a);
        show(pixel + ivec2(0, 1), p.b);
        show(pixel + ivec2(0, 2), p.c);
        show(pixel + ivec2(0, 3), p.d);
        if (++i == 4)
            break;
        ++pixel.x;
        t0 = t0.yzww, t1 = t1.yzww, t2 = t2.yzww, t3 = t3.yzww, t4 = t4.yzww, t5 = t5.yzww, t6 = t6.yzww;
    }
}
