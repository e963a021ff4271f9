#version 460
#extension GL_GOOGLE_include_directive : require
// Forward shading: the same BRDF and the same fitted MIPs, evaluated per pixel. With the level fixed to 0 and
// many shifted frames averaged it is the reference.
#include "lib/footprint.glsl"
#include "lib/surface.glsl"

layout(push_constant, scalar) uniform Constants { ForwardPush push; };
layout(location = 0) in vec3 positionInWorld;
layout(location = 1) in vec3 normalInWorld;
layout(location = 2) in vec4 tangentInWorld;
layout(location = 4) in vec4 uv; // of the reflectance (xy) and of emissive (zw)
layout(location = 5) in vec4 tint;
layout(location = 0) out vec4 colour;

uint listedLights(uint word)
{
    return push.lights[word];
}

uint listedShadows()
{
    return shadowsAmongListed();
}

void main()
{
    ObjectAt object = objectAt(push.draw.object);
    vec4 dx = dFdx(uv), dy = dFdy(uv);
    vec3 levels = vec3(push.draw.level); // of the reflectance, emissive and opacity
    if (push.draw.level < 0.0)
        levels = vec3(levelOf(mapNormal, dx.xy, dy.xy, 1.0), levelOf(mapEmissive, dx.zw, dy.zw, 1.0),
                      levelOf(mapOpacity, dx.xy, dy.xy, 1.0));
    float opacity = textureLod(mapOpacity, uv.xy, max(levels.z, 0.0)).x;
    if (kColoured)
        opacity *= tint.a;
    if ((object.at.flags & kObjectMask) != 0u && opacity < object.at.alphaCutoff)
        discard;
    MaterialTexel material = sampleMaterial(uv, levels.xy);
    if (kColoured)
        material = tinted(object.at.flags, object.at.dielectric, material, max(tint.rgb, vec3(0.0)));
    ShadingPoint point = shadingPoint(object.at.flags, material, positionInWorld, normalInWorld, tangentInWorld);
    vec3 radiance = point.radiance + reflectedFromListed(point);
    colour = vec4(storable(radiance), opacity * push.draw.opacity);
}
