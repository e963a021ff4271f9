#version 460
#extension GL_GOOGLE_include_directive : require
// Floor of lighting: lumels whose surface and material lie ready and packed, by every light of the scene. No tiles,
// lists of lights, shadows or environment.
#include "lib/interface.glsl"
#include "lib/rows.glsl"
#include "shared/shading.h"

layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Constants { FloorPush push; };
layout(set = 1, binding = 1) uniform usampler2DArray surfaces; // layer i: FloorSurface::words[i]
layout(set = 1, binding = 2, rgba16f) writeonly uniform image2DArray lit;

struct Point {
    vec3 position, normal;
    vec4 tangent; // w: handedness
    vec2 lobeNormal;
    vec3 covariance, specular, diffuse, f0;
    float baseVariance;
};

Point pointAt(ivec2 lumel)
{
    uvec4 a = texelFetch(surfaces, ivec3(lumel, 0), 0), b = texelFetch(surfaces, ivec3(lumel, 1), 0),
          c = texelFetch(surfaces, ivec3(lumel, 2), 0);
    vec2 normalXy = unpackHalf2x16(b.x), normalZ = unpackHalf2x16(b.y), covariance = unpackHalf2x16(b.z);
    vec2 specular = unpackHalf2x16(c.x), between = unpackHalf2x16(c.y), diffuse = unpackHalf2x16(c.z);
    vec4 base = unpackUnorm4x8(c.w);
    return Point(uintBitsToFloat(a.xyz), vec3(normalXy, normalZ.x), unpackSnorm4x8(a.w), unpackHalf2x16(b.w),
                 vec3(normalZ.y, covariance), vec3(specular, between.x), vec3(between.y, diffuse), base.rgb, base.a);
}

void main()
{
    uint index = listIndex();
    if (index >= push.lumels)
        return;
    ivec2 lumel = ivec2(index % kFloorSide, index / kFloorSide);
    Point point = pointAt(lumel);
    vec3 toEye = normalize(view.eyeInWorld - point.position);
    vec3 n = normalize(point.normal), t = normalize(point.tangent.xyz - n * dot(n, point.tangent.xyz));
    Lobe local = makeLobe(lobeNormal(point.lobeNormal), point.covariance);
    mat3 worldFromTangent = mat3(t, cross(n, t) * point.tangent.w, n);
    Lobe lobe = Lobe(worldFromTangent * local.normal, worldFromTangent * local.tangentU,
                     worldFromTangent * local.tangentV, local.inverseCovariance, local.scale);
    SurfaceReflectance surface = reflectanceTowards(
        SurfaceTexel(lobe, n, point.specular, point.f0, point.baseVariance, point.diffuse), toEye);
    vec3 radiance = vec3(0.0);
    for (uint i = 0u; i < view.lightCount; ++i) {
        Incident incident = incidentLight(lights[i], point.position);
        radiance += reflectLight(surface, incident.direction, toEye, incident.irradiance);
    }
    imageStore(lit, ivec3(lumel, 0), vec4(min(radiance, vec3(60000.0)), 1.0));
}
