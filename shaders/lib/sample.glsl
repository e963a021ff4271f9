// What a sample of the feedback pass sees of an object, in four words.
#ifndef LUMEL_SAMPLE_GLSL
#define LUMEL_SAMPLE_GLSL

// The difference to the pixel beside one, as drawing will see it, from the difference to the fragment beside it, several
// pixels away: seen at a grazing angle uv varies strongly over them. It is a quotient of two linear functions of the
// screen, the lower of which is 1 / w; so its difference between two places times 1 / w at both is linear in their distance.
float differenceScale(float inverseW, float inverseWDifference, float fragment, float pixel, float divisor)
{
    float far = (int(fragment) & 1) == 0 ? inverseWDifference : -inverseWDifference;
    float near = (int(pixel) & 1) == 0 ? inverseWDifference : -inverseWDifference;
    return (inverseW + far) / (max(inverseW + near / divisor, 1e-3 * inverseW) * divisor);
}

// Of a fragment: object + 1, lit uv as unorm16, its differences to the full-size pixels beside it.
// divisor: full-size pixels per fragment, per axis. jitter: of the fragments, in full-size pixels.
uvec4 sampleHere(uint object, vec2 uv, float divisor, vec2 jitter)
{
    float inverseW = gl_FragCoord.w;
    vec2 fragment = gl_FragCoord.xy, pixel = fragment * divisor - jitter;
    vec2 dx = dFdx(uv) * differenceScale(inverseW, dFdx(inverseW), fragment.x, pixel.x, divisor);
    vec2 dy = dFdy(uv) * differenceScale(inverseW, dFdy(inverseW), fragment.y, pixel.y, divisor);
    return uvec4(object + 1u, packUnorm2x16(uv), packHalf2x16(dx), packHalf2x16(dy));
}
#endif
