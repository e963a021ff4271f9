// A pixel's footprint in texture space, from the screen derivatives of its texture coordinates.
// textureQueryLod is not used: drivers bias it (seen on lavapipe).
#ifndef LUMEL_FOOTPRINT_GLSL
#define LUMEL_FOOTPRINT_GLSL

const int kMostTaps = 16;

struct Footprint {
    float level; // MIP level whose texels match the footprint's width; 0 = one level-0 texel, may be negative
    float elongation; // times as long as wide, or as a texel, up to the most taps
    int taps;    // samples along the long axis
    vec2 axis;   // texture coordinates from the centre to either end of the long axis
};

// Heckbert 1989, "Fundamentals of Texture Mapping", section 3.5.8: the Jacobian maps the pixel's circle to
// an ellipse; its half axes are the singular values. dx, dy: uv derivatives per pixel. anisotropy: most taps.
Footprint footprintOf(vec2 dx, vec2 dy, vec2 size, float anisotropy)
{
    vec2 x = dx * size, y = dy * size; // in texels
    float a = x.x * x.x + y.x * y.x;
    float b = x.x * x.y + y.x * y.y;
    float c = x.y * x.y + y.y * y.y;
    float mean = 0.5 * (a + c);
    float spread = sqrt(0.25 * (a - c) * (a - c) + b * b);
    float major2 = max(mean + spread, 1e-12);
    float minor2 = max(mean - spread, 1e-12);
    float major = sqrt(major2);
    float minor = max(sqrt(minor2), major / max(anisotropy, 1.0));
    vec2 direction = a >= c ? vec2(major2 - c, b) : vec2(b, major2 - a);
    float directionLength = length(direction);
    direction = directionLength > 0.0 ? direction / directionLength : vec2(1.0, 0.0);
    Footprint footprint;
    // Texels finer than level 0 do not exist: a magnified footprint needs no taps.
    footprint.elongation = clamp(major / max(minor, 1.0), 1.0, max(anisotropy, 1.0));
    // To the nearest: rounded up, taps on light cost more and blur.
    footprint.taps = int(floor(footprint.elongation + 0.5));
    footprint.level = log2(max(minor, 1e-6));
    footprint.axis = 0.5 * direction * major / size;
    return footprint;
}

// About as long as wide.
const float kRound = 1.01;

// Taps on reflectance, whose average is no light's: rounded to the nearest, they would miss highlights.
int reflectanceTaps(float elongation)
{
    return clamp(int(ceil(elongation - (kRound - 1.0))), 1, kMostTaps);
}

// The level of a map whose texels match the footprint, by the map's own size: a material's maps differ in it. Below 0
// where the map is magnified; clamp it where the map is read, not before it is compared or shifted.
float levelOf(sampler2D map, vec2 dx, vec2 dy, float anisotropy)
{
    return footprintOf(dx, dy, vec2(textureSize(map, 0)), anisotropy).level;
}
#endif
