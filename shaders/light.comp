#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#extension GL_KHR_shader_subgroup_basic : require
// Light pass: a group lights one 8x8 tile after another of its job's list, an invocation a lumel. The texel map
// says which triangle a lumel lies on; gutter lumels extend the nearest triangle, so that filter taps across a
// chart's border meet a smooth continuation.
#include "lib/geometry.glsl"
#include "lib/surface.glsl"
#include "lib/tiles.glsl"

layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Constants { LightPush push; };
layout(set = 2, binding = 0, rgba16f) uniform image2DArray lit;

// The lumel's point on the surface; uv is its centre's.
ShadingPoint pointOf(ObjectAt object, uint level, uvec2 lumel, uvec2 size, uint triangle)
{
    Vertex a = pullVertex(object, 3u * triangle - 3u);
    Vertex b = pullVertex(object, 3u * triangle - 2u);
    Vertex c = pullVertex(object, 3u * triangle - 1u);
    vec2 uv = (vec2(lumel) + 0.5) / vec2(size);
    vec3 w = barycentrics(a.uv, b.uv, c.uv, uv);
    vec3 position = w.x * a.position + w.y * b.position + w.z * c.position;
    vec3 normal = w.x * a.normal + w.y * b.normal + w.z * c.normal;
    vec3 tangent = w.x * a.tangent.xyz + w.y * b.tangent.xyz + w.z * c.tangent.xyz;
    // Where lumels coincide with the material's texels, their centres do: no filtering. Finer lumels magnify its
    // level 0.
    MaterialTexel material = sampleMaterial(uv, max(float(level) + object.at.materialLevelOffset, 0.0));
    return shadingPoint(object, material, (object.at.worldFromObject * vec4(position, 1.0)).xyz,
                        object.at.worldFromObjectNormal * normal,
                        vec4(mat3(object.at.worldFromObject) * tangent, a.tangent.w));
}

vec3 lightThrough(ShadingPoint point, JobTile job)
{
    vec3 radiance = vec3(0.0);
    for (uint word = 0u; word < kListedLights / 32u && 32u * word < view.lightCount; ++word)
        for (uint bits = job.lights[word]; bits != 0u; bits &= bits - 1u)
            radiance += reflectedFrom(point, lights[32u * word + findLSB(bits)]);
    for (uint i = kListedLights; i < view.lightCount; ++i)
        radiance += reflectedFrom(point, lights[i]);
    return radiance;
}

// Squared change in display value from what the lumel held. A square root stands for the display transform.
float changeOf(vec3 before, vec3 after, float exposure)
{
    vec3 d = sqrt(min(after * exposure, vec3(1.0))) - sqrt(min(before * exposure, vec3(1.0)));
    return dot(d, d) / 3.0;
}

void lightTile(uint slot)
{
    Tile tile = push.tiles.at[slot].tile;
    ObjectAt object = objectAt(tile.object);
    uint mip = placeMip(tile.place);
    uvec2 size = mipSize(object, mip);
    uvec2 lumel = placeTile(tile.place) * kTileSize +
                  uvec2(gl_LocalInvocationIndex % kTileSize, gl_LocalInvocationIndex / kTileSize);
    if (any(greaterThanEqual(lumel, size)))
        return;
    uint level = object.at.litLevel + mip;
    ivec3 place = ivec3(mipOrigin(mipSize(object, 0u), mip) + lumel, object.at.layer);
    uint triangle = texelAt(object, level, lumel) & kTexelTriangleMask;
    if (triangle == 0u) { // a former owner's lumels could be not-a-number
        imageStore(lit, place, vec4(0.0));
        return;
    }
    ShadingPoint point = pointOf(object, level, lumel, size, triangle);
    vec3 radiance = storable(point.radiance + lightThrough(point, push.tiles.at[slot]));
    // Integers add up to the same sum in every order.
    uint change = uint(changeOf(imageLoad(lit, place).rgb, radiance, view.exposure) * (kChangeUnit / 64.0));
    uint sum = subgroupAdd(change);
    if (subgroupElect())
        atomicAdd(object.at.tiles.at[tileIndex(object, mip, placeTile(tile.place))].change, sum);
    imageStore(lit, place, vec4(radiance, 1.0));
}

void main()
{
    Job job = push.jobs.at[push.job];
    for (uint i = gl_WorkGroupID.x; i < job.count; i += gl_NumWorkGroups.x)
        lightTile(job.first + i);
}
