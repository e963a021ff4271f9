// Vertex colours: they multiply a material's base colour (glTF 2.0, section 3.9.2), but what is baked is the
// reflectance made of it.
#ifndef LUMEL_SHARED_TINT_H
#define LUMEL_SHARED_TINT_H
#include "compat.h"
LUMEL_SHARED_BEGIN

// The reflectance F0 of a material whose base colour b is multiplied by `colour`. `dielectric`: the reflectance d of
// what is not metal. Of a surface that is metal by the share m, F0 = d (1 - m) + b m and Kd = b (1 - m) (1 - d), so
// with D = Kd / (1 - d) its colourless part s = d (1 - m) solves s^2 - (F0 + D) s + d D = 0. What reflects no more
// than d is taken for no metal at all.
LUMEL_FN float tintedSpecular(float specular, float diffuse, float dielectric, float colour)
{
    float base = diffuse / max(1.0f - dielectric, 1e-6f);
    float sum = specular + base;
    float own = 0.5f * (sum - sqrt(max(sum * sum - 4.0f * dielectric * base, 0.0f)));
    own = specular <= dielectric ? specular : min(own, specular);
    return own + (specular - own) * colour;
}

// All three channels. The share of metal is common to them, and so is the colourless part of the reflectance: the
// channel that reflects most tells it. A dark one cannot, where metal reflects as little as anything else.
LUMEL_FN vec3 tintedSpecular(vec3 specular, vec3 diffuse, float dielectric, vec3 colour)
{
    int most = specular.x >= max(specular.y, specular.z) ? 0 : specular.y >= specular.z ? 1 : 2;
    float colourless = tintedSpecular(specular[most], diffuse[most], dielectric, 0.0f);
    vec3 own = min(vec3(colourless, colourless, colourless), specular);
    return own + (specular - own) * colour;
}

LUMEL_SHARED_END
#endif
