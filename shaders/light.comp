#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#extension GL_KHR_shader_subgroup_basic : require
// Light pass: a group lights one 8x8 tile after another of its job's list. The texel map
// says which triangle a lumel lies on; gutter lumels extend the nearest triangle, so that filter taps across a
// chart's border meet a smooth continuation.
#include "lib/footprint.glsl"
#include "lib/geometry.glsl"
#include "lib/surface.glsl"
#include "lib/tiles.glsl"

// Lanes: 64, or on devices that run 8 at a time 8, which go over a tile row by row. What they have in common is then
// loaded once for the tile and not once for each row.
layout(local_size_x_id = 3) in;
layout(push_constant, scalar) uniform Constants { LightPush push; };
layout(set = 2, binding = 0, rgba16f) uniform image2DArray lit;

// What lumels of a tile have in common.
struct TileSurface {
    mat4 worldFromObject;
    mat3 worldFromObjectNormal;
    Vertices vertices;
    Indices indices;
    Colours colours;
    vec2 levels;   // of reflectance and emission, where their texels coincide with lumels
    uvec2 size;    // of the MIP
    uint flags;    // kObject...
    float dielectric;
};

TileSurface surfaceOf(ObjectAt object, uint level, uvec2 size)
{
    return TileSurface(object.at.worldFromObject, object.at.worldFromObjectNormal, object.at.vertices,
                       object.at.indices, object.at.colours,
                       float(level) + vec2(object.at.materialLevelOffset, object.at.emissiveLevelOffset), size,
                       object.at.flags, object.at.dielectric);
}

// Where the lumel with barycentric coordinates w reads the material (xy reflectance, zw emission), and at which levels
// of the two.
struct MaterialPlace {
    vec4 uv;
    vec2 levels;
};
MaterialPlace materialPlace(TileSurface surface, Vertex a, Vertex b, Vertex c, vec3 w, vec2 uv)
{
    // Where lumels coincide with the material's texels, their centres do: no filtering. Finer lumels magnify its
    // level 0.
    MaterialPlace same = MaterialPlace(vec4(uv, uv), surface.levels);
    // Else the lumel's parallelogram in material UVs, up to twice as long as wide, is what its texel is to cover;
    // both are linear over the triangle.
    vec2 size = vec2(surface.size);
    vec2 alongB = (b.uv - a.uv) * size, alongC = (c.uv - a.uv) * size; // lumels
    float area = alongB.x * alongC.y - alongB.y * alongC.x;
    float inverseArea = abs(area) > 1e-20 ? 1.0 / area : 0.0;
    vec4 toB = vec4(b.materialUv - a.materialUv, b.emissionUv - a.emissionUv),
         toC = vec4(c.materialUv - a.materialUv, c.emissionUv - a.emissionUv);
    vec4 dx = (toB * alongC.y - toC * alongB.y) * inverseArea, dy = (toC * alongB.x - toB * alongC.x) * inverseArea;
    vec2 own = vec2(levelOf(mapNormal, dx.xy, dy.xy, 2.0), levelOf(mapEmissive, dx.zw, dy.zw, 2.0));
    vec4 place = vec4(w.x * a.materialUv + w.y * b.materialUv + w.z * c.materialUv,
                      w.x * a.emissionUv + w.y * b.emissionUv + w.z * c.emissionUv);
    bool differ = (surface.flags & kObjectOwnMaterialUv) != 0u;
    return MaterialPlace(differ ? place : same.uv, differ ? own : same.levels);
}

// The lumel's point on the surface; uv is its centre's.
ShadingPoint pointOf(TileSurface surface, uvec2 lumel, uint triangle)
{
    uvec3 corners = uvec3(surface.indices.at[3u * triangle - 3u], surface.indices.at[3u * triangle - 2u],
                          surface.indices.at[3u * triangle - 1u]);
    Vertex a = surface.vertices.at[corners.x];
    Vertex b = surface.vertices.at[corners.y];
    Vertex c = surface.vertices.at[corners.z];
    vec2 uv = (vec2(lumel) + 0.5) / vec2(surface.size);
    vec3 w = barycentrics(a.uv, b.uv, c.uv, uv);
    vec3 position = w.x * a.position + w.y * b.position + w.z * c.position;
    vec3 normal = w.x * a.normal + w.y * b.normal + w.z * c.normal;
    vec3 tangent = w.x * a.tangent.xyz + w.y * b.tangent.xyz + w.z * c.tangent.xyz;
    MaterialPlace place = materialPlace(surface, a, b, c, w, uv);
    MaterialTexel material = sampleMaterial(place.uv, place.levels);
    if (kColoured) {
        vec3 colour = vec3(0.0);
        for (uint corner = 0u; corner < 3u; ++corner)
            colour += w[corner] * unpackColour(surface.colours.at[corners[corner]]).rgb;
        material = tinted(surface.flags, surface.dielectric, material, max(colour, vec3(0.0))); // gutters extrapolate
    }
    return shadingPoint(surface.flags, material, (surface.worldFromObject * vec4(position, 1.0)).xyz,
                        surface.worldFromObjectNormal * normal,
                        vec4(mat3(surface.worldFromObject) * tangent, a.tangent.w));
}

// Squared change in display value from what the lumel held. A square root stands for the display transform.
float changeOf(vec3 before, vec3 after, float exposure)
{
    vec3 d = sqrt(min(after * exposure, vec3(1.0))) - sqrt(min(before * exposure, vec3(1.0)));
    return dot(d, d) / 3.0;
}

uint listedSlot, firstListed, shadowsListed; // of the tile
uint listedLights(uint word)
{
    return word == 0u ? firstListed : push.tiles.at[listedSlot].lights[word];
}

uint listedShadows()
{
    return shadowsListed;
}

void lightTile(uint slot)
{
    Tile tile = push.tiles.at[slot].tile;
    listedSlot = slot;
    firstListed = view.lightCount > 0u ? push.tiles.at[slot].lights[0] : 0u; // select.comp writes what there is
    shadowsListed = (kFeatures & kFeatureShadows) != 0u ? shadowsAmongListed() : 0u;
    ObjectAt object = objectAt(tile.object);
    uint mip = placeMip(tile.place);
    uint level = object.at.litLevel + mip;
    TileSurface surface = surfaceOf(object, level, mipSize(object, mip));
    ivec3 origin = ivec3(mipOrigin(mipSize(object, 0u), mip), object.at.layer);
    Texels texels = object.at.texels;
    uint firstTexel = object.at.texelOffsets[level], texelsAcross = max(object.at.litSize.x >> level, 1u);
    uint change = 0u;
    for (uint row = gl_LocalInvocationIndex / kTileSize; row < kTileSize; row += gl_WorkGroupSize.x / kTileSize) {
        uvec2 lumel = placeTile(tile.place) * kTileSize + uvec2(gl_LocalInvocationIndex % kTileSize, row);
        if (any(greaterThanEqual(lumel, surface.size)))
            break;
        ivec3 place = origin + ivec3(lumel, 0);
        uint triangle = texels.at[firstTexel + lumel.y * texelsAcross + lumel.x] & kTexelTriangleMask;
        if (triangle == 0u) { // a former owner's lumels could be not-a-number
            imageStore(lit, place, vec4(0.0));
            continue;
        }
        ShadingPoint point = pointOf(surface, lumel, triangle);
        vec3 radiance = storable(point.radiance + reflectedFromListed(point));
        // Integers add up to the same sum in every order.
        change += uint(changeOf(imageLoad(lit, place).rgb, radiance, view.exposure) * (kChangeUnit / 64.0));
        imageStore(lit, place, vec4(radiance, 1.0));
    }
    uint sum = subgroupAdd(change);
    if (subgroupElect())
        atomicAdd(object.at.tiles.at[tileIndex(object, mip, placeTile(tile.place))].change, sum);
}

void main()
{
    Job job = push.jobs.at[push.job];
    for (uint i = gl_WorkGroupID.x; i < listed(job); i += gl_NumWorkGroups.x)
        lightTile(job.first + i);
}
