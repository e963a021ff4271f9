#version 460
#extension GL_GOOGLE_include_directive : require
// Light pass: each invocation lights one lumel of a listed 8x8 tile at the level its object needs. The texel
// map says which triangle the lumel lies on; gutter lumels extend the nearest triangle, so that filter taps
// across a chart's border meet a smooth continuation.
#include "lib/geometry.glsl"
#include "lib/surface.glsl"

layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Constants { LightPush push; };
layout(set = 1, binding = 0, rgba16f) uniform writeonly image2DArray lit;

// Barycentric coordinates of p in the triangle of texture coordinates a, b, c; extrapolates outside.
vec3 barycentrics(vec2 a, vec2 b, vec2 c, vec2 p)
{
    vec2 ab = b - a, ac = c - a, ap = p - a;
    float area = ab.x * ac.y - ab.y * ac.x;
    float inverseArea = abs(area) > 1e-20 ? 1.0 / area : 0.0;
    float v = (ap.x * ac.y - ap.y * ac.x) * inverseArea;
    float w = (ab.x * ap.y - ab.y * ap.x) * inverseArea;
    return vec3(1.0 - v - w, v, w);
}

void main()
{
    Tile tile = push.tiles.at[gl_WorkGroupID.x];
    View view = push.view.at;
    Object object = view.objects.at[tile.object];
    uvec2 lumel = uvec2(tile.x, tile.y) * kTileSize +
                  uvec2(gl_LocalInvocationIndex % kTileSize, gl_LocalInvocationIndex / kTileSize);
    uint level = object.litLevel;
    uvec2 size = max(object.litSize >> level, uvec2(1u));
    if (any(greaterThanEqual(lumel, size)))
        return;
    uint texel = object.texels.at[object.texelOffsets[level] + lumel.y * size.x + lumel.x];
    uint triangle = texel & kTexelTriangleMask;
    if (triangle == 0u)
        return;

    Vertex a = pullVertex(object, 3u * triangle - 3u);
    Vertex b = pullVertex(object, 3u * triangle - 2u);
    Vertex c = pullVertex(object, 3u * triangle - 1u);
    vec2 uv = (vec2(lumel) + 0.5) / vec2(size);
    vec3 w = barycentrics(a.uv, b.uv, c.uv, uv);
    vec3 position = w.x * a.position + w.y * b.position + w.z * c.position;
    vec3 normal = w.x * a.normal + w.y * b.normal + w.z * c.normal;
    vec3 tangent = w.x * a.tangent.xyz + w.y * b.tangent.xyz + w.z * c.tangent.xyz;

    // Lumels coincide with the material's texels on levels that both have; finer lumels magnify its level 0.
    float materialLevel = float(level) + object.materialLevelOffset;
    bool coincide = materialLevel >= 0.0 && materialLevel == floor(materialLevel) && object.texelsCoincide != 0u;
    MaterialTexel material = coincide ? fetchMaterial(ivec2(lumel), int(materialLevel), uv)
                                      : sampleMaterial(uv, max(materialLevel, 0.0));
    vec3 radiance = shadeSurface(view, object, material, (object.worldFromObject * vec4(position, 1.0)).xyz,
                                 object.worldFromObjectNormal * normal,
                                 vec4(mat3(object.worldFromObject) * tangent, a.tangent.w));
    imageStore(lit, ivec3(lumel, object.layer), vec4(radiance, 1.0));
}
