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
layout(location = 4) in vec4 uv; // of the reflectance (xy) and of glow (zw)
layout(location = 5) in vec4 tint;
layout(location = 0) out vec4 colour;

void main()
{
    ObjectAt object = objectAt(push.draw.object);
    float level = push.draw.level;
    if (level < 0.0)
        level = max(footprintOf(dFdx(uv.xy), dFdy(uv.xy), vec2(textureSize(mapNormal, 0)), 1.0).level, 0.0);
    float opacity = sampleBeside(mapOpacity, uv.xy, level).x;
    if (kColoured)
        opacity *= tint.a;
    if ((object.at.flags & kObjectMask) != 0u && opacity < object.at.alphaCutoff)
        discard;
    MaterialTexel material = sampleMaterial(object, uv, level);
    if (kColoured)
        material = tinted(object, material, max(tint.rgb, vec3(0.0)));
    ShadingPoint point = shadingPoint(object, material, positionInWorld, normalInWorld, tangentInWorld);
    vec3 radiance = point.radiance + reflectedFromListed(point, push.lights);
    colour = vec4(storable(radiance), opacity * push.draw.opacity);
}
