#version 460
#extension GL_GOOGLE_include_directive : require
// Lower levels: a lumel is the average of its four children, weighted by how much surface they cover. A gutter
// lumel takes the mean of the covered lumels near it (dilation), nearer ones weighing more, so that no filter
// tap meets an unlit lumel. A group derives one tile after another of its job's list, and all of an object's tail.
#define LUMEL_TILE_STATES coherent // a tail's MIPs are made of each other
#include "lib/tiles.glsl"

layout(local_size_x_id = 3) in; // lanes, as in light.comp
layout(push_constant, scalar) uniform Constants { LightPush push; };
layout(set = 1, binding = 0, rgba16f) coherent uniform image2DArray lit;

const int kDilation = 2; // lumels: the reach of a cubic filter's taps

// One MIP of a lit texture: where its lumels, tiles and texel map entries lie.
struct Mip {
    uvec2 size;
    uvec2 origin;
    uint firstTexel;
    uint firstTile;
    uint tilesAcross;
};
Mip mipOf(ObjectAt object, uint mip)
{
    uvec2 size = mipSize(object, mip);
    return Mip(size, mipOrigin(mipSize(object, 0u), mip), object.at.texelOffsets[object.at.litLevel + mip],
               object.at.tileOffsets[mip], tileCount(size).x);
}

// What lumels of a tile have in common.
struct Source {
    Mip fine, coarse;
    uvec2 ratio; // of their sizes: 2, or 1 once an axis has reached one lumel
    Texels texels;
    TileStates tiles;
    uint layer;
};

uint texelOf(Source source, Mip mip, uvec2 lumel)
{
    return source.texels.at[mip.firstTexel + lumel.y * mip.size.x + lumel.x];
}

// rgb: weighted sum of the children's radiance, a: sum of weights. Only children in lit tiles.
vec4 gather(Source source, uvec2 lumel)
{
    vec4 sum = vec4(0.0);
    uvec2 first = lumel * source.ratio, tile = first / kTileSize;
    if (source.tiles.at[source.fine.firstTile + tile.y * source.fine.tilesAcross + tile.x].lit == 0u)
        return sum;
    for (uint j = 0u; j < source.ratio.y; ++j)
        for (uint i = 0u; i < source.ratio.x; ++i) {
            uvec2 child = first + uvec2(i, j);
            float weight = float(texelOf(source, source.fine, child) >> kTexelCoverageShift);
            if (weight > 0.0)
                sum += weight * vec4(imageLoad(lit, ivec3(source.fine.origin + child, source.layer)).rgb, 1.0);
        }
    return sum;
}

vec3 derive(Source source, uvec2 lumel)
{
    vec4 sum = vec4(0.0);
    uint texel = texelOf(source, source.coarse, lumel);
    if (texel >> kTexelCoverageShift > 0u) {
        sum = gather(source, lumel);
    } else if (texel != 0u) {
        for (int j = -kDilation; j <= kDilation; ++j)
            for (int i = -kDilation; i <= kDilation; ++i) {
                ivec2 near = ivec2(lumel) + ivec2(i, j);
                if (any(lessThan(near, ivec2(0))) || any(greaterThanEqual(near, ivec2(source.coarse.size))))
                    continue;
                if (texelOf(source, source.coarse, uvec2(near)) >> kTexelCoverageShift == 0u)
                    continue;
                vec4 found = gather(source, uvec2(near));
                float distance2 = float(i * i + j * j);
                sum += found / max(found.a, 1e-6) / (distance2 * distance2);
            }
    }
    return sum.rgb / max(sum.a, 1e-6);
}

void deriveTile(ObjectAt object, uint mip, uvec2 tile)
{
    if (push.waiting != 0u && childrenLit(object, mip, tile) == 0u)
        return; // not yet
    Source source = Source(mipOf(object, mip - 1u), mipOf(object, mip),
                           mipSize(object, mip - 1u) / mipSize(object, mip), object.at.texels, object.at.tiles,
                           object.at.layer);
    uint local = gl_LocalInvocationIndex;
    for (uint row = local / kTileSize; row < kTileSize; row += gl_WorkGroupSize.x / kTileSize) {
        uvec2 lumel = tile * kTileSize + uvec2(local % kTileSize, row);
        if (any(greaterThanEqual(lumel, source.coarse.size)))
            break;
        imageStore(lit, ivec3(source.coarse.origin + lumel, source.layer), vec4(derive(source, lumel), 1.0));
    }
    if (local != 0u)
        return;
    uint index = tileIndex(object, mip, tile);
    uvec2 ratio = mipSize(object, mip - 1u) / mipSize(object, mip);
    TileState child = lightState(object, tileIndex(object, mip - 1u, tile * ratio));
    bool waited = (object.at.tiles.at[index].derive & kDeriveWaited) != 0u;
    object.at.tiles.at[index].lit = childrenLit(object, mip, tile);
    object.at.tiles.at[index].eye = child.eye;
    object.at.tiles.at[index].centre = child.centre;
    object.at.tiles.at[index].radius = 2.0 * child.radius;
    object.at.tiles.at[index].rate = rateOf(child);
    object.at.tiles.at[index].turned = kTurnedOfDerived;
    object.at.tiles.at[index].change = 0u;
    if (object.at.tiles.at[index].shown == 0u)
        object.at.tiles.at[index].shown = waited ? view.frame : kShownAtOnce;
}

void main()
{
    Job job = push.jobs.at[push.job];
    for (uint i = gl_WorkGroupID.x; i < listed(job); i += gl_NumWorkGroups.x) {
        Tile tile = push.tiles.at[job.first + i].tile;
        ObjectAt object = objectAt(tile.object);
        uint mip = placeMip(tile.place), last = mip < derivedTail(object.at.mips) ? mip : object.at.mips - 1u;
        for (; mip <= last; ++mip) {
            uint derive = object.at.tiles.at[tileIndex(object, mip, placeTile(tile.place))].derive;
            if ((derive & kDeriveQueued) != 0u && derive >> kDeriveBits == view.frame)
                deriveTile(object, mip, placeTile(tile.place));
            if (mip < last) {
                memoryBarrierImage();
                memoryBarrierBuffer();
                barrier(); // the next MIP is made of this one
            }
        }
    }
}
