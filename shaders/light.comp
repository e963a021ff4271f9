#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#extension GL_KHR_shader_subgroup_basic : require
// Light pass, of tiles whose surface is not cached: it is found from the mesh and the material, and kept in the surface
// cache where the tile has a place there. The texel map says which triangle a lumel lies on; gutter lumels extend the
// nearest triangle, so that filter taps across a chart's border meet a smooth continuation.
#include "lib/footprint.glsl"
#include "lib/geometry.glsl"
#include "lib/light_tiles.glsl"
#include "lib/material.glsl"

layout(set = 3, binding = 0) uniform usamplerBuffer vertexTexels;

Vertex vertexAt(uint index)
{
    int first = int(4u * index);
    vec4 a = uintBitsToFloat(texelFetch(vertexTexels, first)), b = uintBitsToFloat(texelFetch(vertexTexels, first + 1)),
         c = uintBitsToFloat(texelFetch(vertexTexels, first + 2)), d = uintBitsToFloat(texelFetch(vertexTexels, first + 3));
    return Vertex(a.xyz, vec3(a.w, b.xy), vec4(b.zw, c.xy), c.zw, d.xy, d.zw);
}

// What lumels of a tile have in common.
struct TileSurface {
    mat4 worldFromObject;
    mat3 worldFromObjectNormal;
    Texels texels;
    uint firstVertex;
    Indices indices;
    Colours colours;
    vec2 levels;   // of reflectance and emission, where their texels coincide with lumels
    uvec2 size;    // of the MIP
    uint flags;    // kObject...
    float dielectric;
};

TileSurface surfaceOf(ObjectAt object, uint level, uvec2 size)
{
    return TileSurface(object.at.worldFromObject, object.at.worldFromObjectNormal, object.at.texels,
                       object.at.firstVertex, object.at.indices, object.at.colours,
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
SurfacePoint pointOf(TileSurface surface, uvec2 lumel, uint triangle)
{
    uvec3 corners = uvec3(surface.indices.at[3u * triangle - 3u], surface.indices.at[3u * triangle - 2u],
                          surface.indices.at[3u * triangle - 1u]);
    Vertex a = vertexAt(surface.firstVertex + corners.x);
    Vertex b = vertexAt(surface.firstVertex + corners.y);
    Vertex c = vertexAt(surface.firstVertex + corners.z);
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
    return surfacePoint(surface.flags, material, (surface.worldFromObject * vec4(position, 1.0)).xyz,
                        surface.worldFromObjectNormal * normal,
                        vec4(mat3(surface.worldFromObject) * tangent, a.tangent.w));
}

TileSurface tileSurface;
uint tileTexels;

void beginTile(LitObject object, JobTile job)
{
    uint mip = placeMip(job.tile.place), level = object.litLevel + mip;
    tileSurface = surfaceOf(objectAt(job.tile.object), level, mipSize(object, mip));
    tileTexels = object.texels.at[tileWords(object, level, placeTile(job.tile.place)) + 1u];
}

LumelSurface surfaceOfLumel(uvec2 lumel)
{
    LumelSurface result;
    result.record = noSurface();
    result.visible = uvec2(0u);
    uint triangle = texelOfTile(tileSurface.texels, tileTexels, lumel) & kTexelTriangleMask;
    if (triangle != 0u)
        result.record = packSurface(pointOf(tileSurface, lumel, triangle));
    result.changed = true;
    return result;
}
