#version 460
#extension GL_GOOGLE_include_directive : require
// Forward shading: the same BRDF and the same fitted MIPs, evaluated per pixel. With the level fixed to 0 and
// many shifted frames averaged it is the reference.
#include "lib/footprint.glsl"
#include "lib/surface.glsl"

layout(push_constant, scalar) uniform Constants { DrawPush push; };
layout(location = 0) in vec3 positionInWorld;
layout(location = 1) in vec3 normalInWorld;
layout(location = 2) in vec4 tangentInWorld;
layout(location = 3) in vec2 uv;
layout(location = 0) out vec4 colour;

void main()
{
    View view = push.view.at;
    Object object = view.objects.at[push.object];
    float level = push.level;
    if (level < 0.0)
        level = max(footprintOf(dFdx(uv), dFdy(uv), vec2(textureSize(mapNormal, 0)), 1.0).level, 0.0);
    float opacity = sampleBeside(mapOpacity, uv, level).x;
    if ((object.flags & kObjectMask) != 0u && opacity < object.alphaCutoff)
        discard;
    MaterialTexel material = sampleMaterial(uv, level);
    colour = vec4(shadeSurface(view, object, material, positionInWorld, normalInWorld, tangentInWorld), opacity);
}
