// Display transform: the only place where radiance becomes display colour.
// Khronos PBR Neutral (Khronos Group 2024, "PBR Neutral Tone Mapper Specification"): 1:1 below 0.8 minus
// the Fresnel offset, so that base colours keep their look, with a hyperbolic shoulder and desaturation above.
#ifndef LUMEL_SHARED_TONEMAP_H
#define LUMEL_SHARED_TONEMAP_H
#include "compat.h"
LUMEL_SHARED_BEGIN

// Linear Rec. 709 in, scene-referred, >= 0; linear display colour in [0, 1] out.
LUMEL_FN vec3 toneMap(vec3 colour)
{
    const float startCompression = 0.8f - 0.04f;
    const float desaturation = 0.15f;
    float x = min(colour.x, min(colour.y, colour.z));
    float offset = x < 0.08f ? x - 6.25f * x * x : 0.04f;
    colour -= vec3(offset, offset, offset);
    float peak = max(colour.x, max(colour.y, colour.z));
    if (peak < startCompression)
        return colour;
    float d = 1.0f - startCompression;
    float newPeak = 1.0f - d * d / (peak + d - startCompression);
    colour *= newPeak / peak;
    float g = 1.0f - 1.0f / (desaturation * (peak - newPeak) + 1.0f);
    return mix(colour, vec3(newPeak, newPeak, newPeak), g);
}

LUMEL_CONST uint kToneMapNeutral = 0u;
LUMEL_CONST uint kToneMapAces = 1u;
LUMEL_CONST uint kToneMapClamp = 2u;

// Narkowicz 2015, "ACES Filmic Tone Mapping Curve": a fit of its look for displays.
LUMEL_FN vec3 toneMapAces(vec3 x)
{
    return (x * (2.51f * x + vec3(0.03f, 0.03f, 0.03f))) /
           (x * (2.43f * x + vec3(0.59f, 0.59f, 0.59f)) + vec3(0.14f, 0.14f, 0.14f));
}

// IEC 61966-2-1, piecewise.
LUMEL_FN float encodeSrgb(float linear)
{
    return linear <= 0.0031308f ? linear * 12.92f : 1.055f * pow(linear, 1.0f / 2.4f) - 0.055f;
}

// The same for 8-bit displays, within 0.0002 (0.05 of a step): powers cost more than all else here. A rational
// minimax fit in the square root, whose 5/6th power the curve is. Shares 0 with it, rises everywhere, stays below 1.
LUMEL_FN float encodeForDisplay(float linear)
{
    float s = sqrt(linear);
    float curve = (-0.04380592f + s * (1.43966536f + s * 4.53248698f)) / (1.0f + s * (4.54736905f + s * 0.38167795f));
    return linear <= 0.0031308f ? linear * 12.92f : curve;
}

// Scene radiance to 8-bit-ready sRGB, exposure included.
LUMEL_FN vec3 displayColour(vec3 radiance, float exposure, uint mapper)
{
    vec3 scene = max(radiance * exposure, vec3(0.0f, 0.0f, 0.0f));
    if (mapper == kToneMapNeutral)
        scene = toneMap(scene);
    else if (mapper == kToneMapAces)
        scene = toneMapAces(scene);
    vec3 mapped = clamp(scene, vec3(0.0f, 0.0f, 0.0f), vec3(1.0f, 1.0f, 1.0f));
    return vec3(encodeForDisplay(mapped.x), encodeForDisplay(mapped.y), encodeForDisplay(mapped.z));
}

// By the default tone mapper.
LUMEL_FN vec3 displayColour(vec3 radiance, float exposure)
{
    return displayColour(radiance, exposure, kToneMapNeutral);
}

LUMEL_SHARED_END
#endif
