// How much of a light reaches a point.
#ifndef LUMEL_SHADOW_GLSL
#define LUMEL_SHADOW_GLSL
#include "lib/interface.glsl"

layout(set = 0, binding = 3) uniform sampler2DArrayShadow shadowMaps; // reversed depth: greater is nearer

// Percentage-closer filtering (Reeves, Salesin and Cook 1987) by four bilinear comparisons half a texel apart:
// an edge two texels wide. normal: of the macro surface.
float lightVisibility(Shadow shadow, uint layer, vec3 position, vec3 normal, vec3 toLight)
{
    // Texels are larger farther from a spot light; w is the distance along its axis, 1 for a sun.
    float texel = shadow.texel * max((shadow.mapFromWorld * vec4(position, 1.0)).w, 0.0);
    // A filter that reaches r texels needs the surface raised by r sin(angle) along its normal, so that no part of
    // a plane shades another (Holbert 2011, "Normal Offset Shadows"); what curves is raised a little more.
    float cosine = dot(normal, toLight);
    float raised = 2.0 * sqrt(max(1.0 - cosine * cosine, 0.0)) + 0.3;
    vec4 place = shadow.mapFromWorld * vec4(position + (raised * normal + 0.7 * toLight) * texel, 1.0);
    vec3 p = place.xyz / max(place.w, 1e-20);
    vec2 step = 0.5 / vec2(textureSize(shadowMaps, 0).xy);
    float map = float(layer);
    return 0.25 * (texture(shadowMaps, vec4(p.xy - step, map, p.z)) +
                   texture(shadowMaps, vec4(p.x + step.x, p.y - step.y, map, p.z)) +
                   texture(shadowMaps, vec4(p.x - step.x, p.y + step.y, map, p.z)) +
                   texture(shadowMaps, vec4(p.xy + step, map, p.z)));
}
#endif
