#version 460
#extension GL_GOOGLE_include_directive : require
// Plan, fourth step: balls around the surface of tiles to be lit for the first time, or whose object has moved.
#include "lib/geometry.glsl"
#include "lib/plan.glsl"

layout(local_size_x_id = 3) in; // lanes, as in lib/light_tiles.glsl

// World position of a lumel's point on the surface; w = 0 where there is none.
vec4 positionOf(LitObject object, ObjectAt mesh, uint level, uvec2 lumel)
{
    uint triangle = texelAt(object, level, lumel) & kTexelTriangleMask;
    if (triangle == 0u)
        return vec4(0.0);
    Vertex a = pullVertex(mesh, 3u * triangle - 3u);
    Vertex b = pullVertex(mesh, 3u * triangle - 2u);
    Vertex c = pullVertex(mesh, 3u * triangle - 1u);
    vec2 size = vec2(max(object.litSize >> level, uvec2(1u)));
    vec3 w = barycentrics(a.uv, b.uv, c.uv, (vec2(lumel) + 0.5) / size);
    vec3 position = w.x * a.position + w.y * b.position + w.z * c.position;
    return vec4((mesh.at.worldFromObject * vec4(position, 1.0)).xyz, 1.0);
}

// Centre and radius (w): from the tile's corners and centre where all lie on the surface, else from every lumel.
vec4 ballOf(LitObject object, ObjectAt mesh, uint mip, uvec2 tile)
{
    uint level = object.litLevel + mip;
    uvec2 last = min(mipSize(object, mip), uvec2(kTileSize)) - 1u;
    vec3 lower = vec3(1e30), upper = vec3(-1e30);
    uint found = 0u;
    for (uint i = 0u; i < 5u;) {
        uvec2 step = i == 4u ? last / 2u : last * uvec2(i & 1u, i >> 1u);
        vec4 p = positionOf(object, mesh, level, tile * kTileSize + step);
        found += uint(p.w);
        lower = min(lower, p.w > 0.0 ? p.xyz : lower);
        upper = max(upper, p.w > 0.0 ? p.xyz : upper);
        if (++i == 5u)
            break;
    }
    for (uint i = found == 5u ? kTileLumels : 0u; i < kTileLumels;) {
        uvec2 step = min(uvec2(i % kTileSize, i / kTileSize), last);
        vec4 p = positionOf(object, mesh, level, tile * kTileSize + step);
        lower = min(lower, p.w > 0.0 ? p.xyz : lower);
        upper = max(upper, p.w > 0.0 ? p.xyz : upper);
        if (++i == kTileLumels)
            break;
    }
    const float kBulge = 1.25; // of a curved surface between its corners
    return vec4(0.5 * (lower + upper), 0.5 * kBulge * length(max(upper - lower, vec3(0.0))));
}

void findBall(Tile tile)
{
    LitObject object = litObject(tile.object);
    uint mip = placeMip(tile.place), index = tileIndex(object, mip, placeTile(tile.place));
    vec4 ball = ballOf(object, objectAt(tile.object), mip, placeTile(tile.place));
    object.tiles.at[index].centre = ball.xyz;
    object.tiles.at[index].radius = ball.w;
}

void main()
{
    uint i = gl_WorkGroupID.x * gl_WorkGroupSize.x + gl_LocalInvocationIndex, count = push.plan.at.unbound;
    do {
        if (i < count)
            findBall(push.marks.at[2u * push.markCapacity + i].tile);
        i += gl_NumWorkGroups.x * gl_WorkGroupSize.x;
    } while (i < count);
}
