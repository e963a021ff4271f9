#version 460
#extension GL_GOOGLE_include_directive : require
// Lower levels: a lumel is the average of its four children, weighted by how much surface they cover. A gutter
// lumel is the nearest covered lumel, as the texel map says, so that no filter tap meets an unlit lumel. A group derives
// one tile after another of its job's list, and all of an object's tail.
#define LUMEL_TILE_STATES coherent // a tail's MIPs are made of each other
#include "lib/tiles.glsl"

layout(local_size_x_id = 3) in; // lanes, as in lib/light_tiles.glsl
layout(push_constant, scalar) uniform Constants { LightPush push; };
layout(set = 1, binding = 0, rgba16f) coherent uniform image2DArray lit;

// One MIP of a lit texture: where its lumels, tiles and texel map entries lie.
struct Mip {
    uvec2 size;
    uvec2 origin;
    uint firstTexel;
    uint firstTile;
    uint tilesAcross;
};
Mip mipOf(LitObject object, uint mip)
{
    uvec2 size = mipSize(object, mip);
    return Mip(size, mipOrigin(mipSize(object, 0u), mip), texelOffset(object, object.litLevel + mip),
               tileOffset(object, mip), tileCount(size).x);
}

// What lumels of a tile have in common.
struct Source {
    Mip fine, coarse;
    uvec2 ratio; // of their sizes: 2, or 1 once an axis has reached one lumel
    Texels texels;
    uint layer;
};

uint texelOf(Source source, Mip mip, uvec2 lumel)
{
    return source.texels.at[mip.firstTexel + lumel.y * mip.size.x + lumel.x];
}

// Linear radiance, and in w whether any of the children holds light.
vec4 derive(Source source, uvec2 lumel)
{
    uint texel = texelOf(source, source.coarse, lumel);
    if ((texel & kTexelGutter) != 0u)
        lumel = uvec2(ivec2(lumel) + gutterSource(texel));
    vec4 sum = vec4(0.0);
    for (uint i = 0u; i < 4u; ++i) { // where an axis does not halve, twice the same: the mean is the same too
        uvec2 child = lumel * source.ratio + min(uvec2(i & 1u, i >> 1u), source.ratio - 1u);
        vec4 light = imageLoad(lit, ivec3(source.fine.origin + child, source.layer));
        sum += float(texelCoverage(texelOf(source, source.fine, child))) * light.a * vec4(light.rgb, 1.0);
    }
    return sum.a > 0.0 ? vec4(sum.rgb / sum.a, 1.0) : vec4(0.0);
}

// quads: that were derived. newer: whose former light is out of date.
void noteDerived(LitObject object, uint index, uint quads, uint newer, uint youngest, TileState child, bool waited)
{
    uint held = object.tiles.at[index].held, derived = held >> 16u;
    held = (held & kAllQuads & ~quads) | (((derived & ~newer) | quads) << 16u);
    object.tiles.at[index].held = held;
    object.tiles.at[index].derived = youngest;
    if ((held & kAllQuads) == 0u) { // all that is known of its light is its child's
        object.tiles.at[index].lit = youngest;
        object.tiles.at[index].eye = child.eye;
        object.tiles.at[index].centre = child.centre;
        object.tiles.at[index].radius = 2.0 * child.radius;
        object.tiles.at[index].rate = rateOf(child);
        object.tiles.at[index].turned = kTurnedOfDerived;
        object.tiles.at[index].change = 0u;
    }
    if (object.tiles.at[index].shown == 0u)
        object.tiles.at[index].shown = waited ? view.frame : kShownAtOnce;
}

// wrong: quads whose light must not be drawn, even where no sample saw that it is needed.
void deriveTile(LitObject object, uint mip, uvec2 tile, uint quads, uint wrong, bool waited)
{
    uint index = tileIndex(object, mip, tile);
    Children children = childrenOf(object, mip, tile, object.tiles.at[index].derived);
    quads &= children.held & (children.newer | ~(object.tiles.at[index].held >> 16u)); // the others are up to date
    Source source = Source(mipOf(object, mip - 1u), mipOf(object, mip),
                           mipSize(object, mip - 1u) / mipSize(object, mip), object.texels, object.layer);
    uint changed = quads | wrong;
    uint local = gl_LocalInvocationIndex, count = bitCount(changed);
    for (uint i = local / kQuadLumels; i < count;) {
        uint quad = quadOf(changed, i);
        uvec2 lumel = tile * kTileSize + lumelOf(quad, local % kQuadLumels);
        vec4 light = (quads >> quad & 1u) != 0u ? derive(source, min(lumel, source.coarse.size - 1u)) : vec4(0.0);
        if (all(lessThan(lumel, source.coarse.size)))
            imageStore(lit, ivec3(source.coarse.origin + lumel, source.layer), light);
        i += gl_WorkGroupSize.x / kQuadLumels;
        if (i >= count)
            break;
    }
    barrier(); // all have read the tile's state
    if (local != 0u || changed == 0u)
        return;
    atomicAdd(push.plan.at.quadsDerived, bitCount(quads));
    TileState child = lightState(object, tileIndex(object, mip - 1u, tile * source.ratio));
    noteDerived(object, index, quads, children.newer | wrong, children.youngest, child, waited);
}

// A tile of the list; of the tail's first MIP, and all that follow from it.
void deriveEntry(JobTile entry)
{
    LitObject object = litObject(entry.tile.object);
    uint mip = placeMip(entry.tile.place), last = mip < derivedTail(object.mips) ? mip : object.mips - 1u;
    bool waited = (entry.tile.place & kPlaceWaited) != 0u;
    uint quads = entry.quads & kAllQuads, wrong = entry.quads >> 16u;
    for (;;) {
        deriveTile(object, mip, placeTile(entry.tile.place), quads, wrong, waited);
        if (mip >= last)
            break;
        memoryBarrierImage();
        memoryBarrierBuffer();
        barrier(); // the next MIP is made of this one
        ++mip;
        quads = surfaceQuads(object, mip, uvec2(0u)); // the view needs all of it
        wrong = 0u;
    }
}

void main()
{
    Job job = push.jobs.at[push.job];
    uint i = gl_WorkGroupID.x, count = listed(job);
    do {
        deriveEntry(push.tiles.at[job.first + i]);
        i += gl_NumWorkGroups.x;
    } while (i < count);
}
