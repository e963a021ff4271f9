// Automatic exposure: how a picture's luminances are counted.
#ifndef LUMEL_SHARED_METER_H
#define LUMEL_SHARED_METER_H
#include "compat.h"
LUMEL_SHARED_BEGIN

// Eight bins per octave, from 2^-16 to 2^16; the first also holds all that is darker, the last what is brighter.
LUMEL_CONST uint kMeterBins = 256u;
LUMEL_CONST int kMeterFirstOctave = -16;

// ITU-R BT.709, of linear colour.
LUMEL_FN float luminanceOf(vec3 colour)
{
    return 0.2126f * colour.x + 0.7152f * colour.y + 0.0722f * colour.z;
}

// The exponent and the first three bits of the mantissa (IEEE 754): no logarithm that devices round differently.
LUMEL_FN uint meterBin(float luminance)
{
    uint bits = floatBitsToUint(luminance > 0.0f ? luminance : 0.0f);
    return uint(clamp(int(bits >> 20u) - ((127 + kMeterFirstOctave) << 3), 0, int(kMeterBins) - 1));
}

LUMEL_SHARED_END
#endif
