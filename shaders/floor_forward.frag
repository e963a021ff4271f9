#version 460
#extension GL_GOOGLE_include_directive : require
// Floor of forward shading: the material's maps, one trilinear lookup each, and every light of the scene by the same
// formulas. No list of lights, shadows, environment, opacity or vertex colours.
#include "lib/footprint.glsl"
#include "lib/material.glsl"

layout(push_constant, scalar) uniform Constants { DrawPush push; }; // for the vertex shader
layout(location = 0) in vec3 positionInWorld;
layout(location = 1) in vec3 normalInWorld;
layout(location = 2) in vec4 tangentInWorld;
layout(location = 4) in vec4 uv; // of the reflectance (xy) and of emissive (zw)
layout(location = 0) out vec4 colour;

uint listedLights(uint word)
{
    return 0u; // it reads no list
}

uint listedShadows()
{
    return 0u;
}

float listedVisibility(uint shadow, ShadingPoint point, vec3 toLight)
{
    return 1.0;
}

void main()
{
    vec4 dx = dFdx(uv), dy = dFdy(uv);
    vec2 levels =
        vec2(levelOf(mapNormal, dx.xy, dy.xy, 1.0), levelOf(mapEmissive, dx.zw, dy.zw, 1.0));
    ShadingPoint point = shadingPoint(
        0u, surfacePoint(0u, sampleMaterial(uv, levels), positionInWorld, normalInWorld, tangentInWorld));
    vec3 radiance = point.radiance;
    for (uint i = 0u; i < view.lightCount; ++i)
        radiance += reflectedFrom(point, lights[i]);
    colour = vec4(storable(radiance), 1.0);
}
