// What a sample of the feedback pass sees of an object, in four words.
#ifndef LUMEL_SAMPLE_GLSL
#define LUMEL_SAMPLE_GLSL

// Object + 1, lit uv as unorm16, its derivatives per full-size pixel to the right and down.
uvec4 packSample(uint object, vec2 uv, vec2 dx, vec2 dy)
{
    return uvec4(object + 1u, packUnorm2x16(uv), packHalf2x16(dx), packHalf2x16(dy));
}
#endif
