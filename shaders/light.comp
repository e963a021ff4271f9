#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#extension GL_KHR_shader_subgroup_basic : require
// Light pass: a group lights one 8x8 tile after another of its job's list, an invocation a lumel. The texel map
// says which triangle a lumel lies on; gutter lumels extend the nearest triangle, so that filter taps across a
// chart's border meet a smooth continuation.
#include "lib/footprint.glsl"
#include "lib/geometry.glsl"
#include "lib/surface.glsl"
#include "lib/tiles.glsl"

layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Constants { LightPush push; };
layout(set = 2, binding = 0, rgba16f) uniform image2DArray lit;

// Where the lumel with barycentric coordinates w reads the material (xy reflectance, zw emissive), and at which levels of
// the two.
struct MaterialPlace {
    vec4 uv;
    vec2 levels;
};
MaterialPlace materialPlace(ObjectAt object, Vertex a, Vertex b, Vertex c, vec3 w, uint level, uvec2 size, vec2 uv)
{
    // Where lumels coincide with the material's texels, their centres do: no filtering. Finer lumels magnify its
    // level 0.
    MaterialPlace same = MaterialPlace(
        vec4(uv, uv), float(level) + vec2(object.at.materialLevelOffset, object.at.emissiveLevelOffset));
    // Else the lumel's parallelogram in material UVs, up to twice as long as wide, is what its texel is to cover;
    // both are linear over the triangle.
    vec2 alongB = (b.uv - a.uv) * vec2(size), alongC = (c.uv - a.uv) * vec2(size); // lumels
    float area = alongB.x * alongC.y - alongB.y * alongC.x;
    float inverseArea = abs(area) > 1e-20 ? 1.0 / area : 0.0;
    vec4 toB = vec4(b.materialUv - a.materialUv, b.emissionUv - a.emissionUv),
         toC = vec4(c.materialUv - a.materialUv, c.emissionUv - a.emissionUv);
    vec4 dx = (toB * alongC.y - toC * alongB.y) * inverseArea, dy = (toC * alongB.x - toB * alongC.x) * inverseArea;
    vec2 own = vec2(levelOf(mapNormal, dx.xy, dy.xy, 2.0), levelOf(mapEmissive, dx.zw, dy.zw, 2.0));
    vec4 place = vec4(w.x * a.materialUv + w.y * b.materialUv + w.z * c.materialUv,
                      w.x * a.emissionUv + w.y * b.emissionUv + w.z * c.emissionUv);
    bool differ = (object.at.flags & kObjectOwnMaterialUv) != 0u;
    return MaterialPlace(differ ? place : same.uv, differ ? own : same.levels);
}

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
    MaterialPlace place = materialPlace(object, a, b, c, w, level, size, uv);
    MaterialTexel material = sampleMaterial(place.uv, place.levels);
    if (kColoured) {
        vec3 colour = vec3(0.0);
        for (uint corner = 0u; corner < 3u; ++corner)
            colour += w[corner] * vertexColour(object, object.at.indices.at[3u * triangle - 3u + corner]).rgb;
        material = tinted(object, material, max(colour, vec3(0.0))); // gutters extrapolate
    }
    return shadingPoint(object, material, (object.at.worldFromObject * vec4(position, 1.0)).xyz,
                        object.at.worldFromObjectNormal * normal,
                        vec4(mat3(object.at.worldFromObject) * tangent, a.tangent.w));
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
    vec3 radiance = storable(point.radiance + reflectedFromListed(point, push.tiles.at[slot].lights));
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
    for (uint i = gl_WorkGroupID.x; i < listed(job); i += gl_NumWorkGroups.x)
        lightTile(job.first + i);
}
