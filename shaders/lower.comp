#version 460
#extension GL_GOOGLE_include_directive : require
// Lower levels: a lumel is the average of its four children, weighted by how much surface they cover. A gutter
// lumel is the nearest covered lumel, as the texel map says, so that no filter tap meets an unlit lumel. A group looks at
// several tiles of its job's list, one a lane, and then derives together what has to be. Of an object's tail it derives
// one MIP after another.
#define LUMEL_TILE_STATES coherent // a tail's MIPs are made of each other
#include "lib/tiles.glsl"

layout(local_size_x_id = 3) in; // lanes, as in lib/light_tiles.glsl
layout(push_constant, scalar) uniform Constants { LightPush push; };
layout(set = 1, binding = 0, rgba16f) coherent uniform image2DArray lit;

const bool kTail = (kFeatures & kFeatureTail) != 0u;
const uint kTilesAtOnce = kTail ? 1u : kLowerTiles;

// One MIP of a lit texture: where its lumels, tiles and texel map entries lie.
struct Mip {
    uvec2 size;
    uvec2 origin;
    uint firstWords; // of its tiles in the texel map
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
    uint tileTexels; // of the tile, in the texel map
    uint layer;
};

// The second word in the texel map of the tile that a lumel lies in.
uint tileTexelsOf(Source source, Mip mip, uvec2 lumel)
{
    uvec2 tile = lumel / kTileSize;
    return source.texels.at[mip.firstWords + 2u * (tile.y * mip.tilesAcross + tile.x) + 1u];
}

// Linear radiance, and in w whether any of the children holds light. whole: surface covers the lumel.
vec4 derive(Source source, uvec2 lumel, bool whole)
{
    uint texel = whole ? 0u : texelOfTile(source.texels, source.tileTexels, lumel);
    if ((texel & kTexelGutter) != 0u)
        lumel = uvec2(ivec2(lumel) + gutterSource(texel));
    uint tileTexels = whole ? 0u : tileTexelsOf(source, source.fine, lumel * source.ratio); // of all four children
    vec4 sum = vec4(0.0);
    for (uint i = 0u; i < 4u; ++i) { // where an axis does not halve, twice the same: the mean is the same too
        uvec2 child = lumel * source.ratio + min(uvec2(i & 1u, i >> 1u), source.ratio - 1u);
        vec4 light = imageLoad(lit, ivec3(source.fine.origin + child, source.layer));
        float coverage = whole ? 1.0 : float(texelCoverage(texelOfTile(source.texels, tileTexels, child)));
        sum += coverage * light.a * vec4(light.rgb, 1.0);
    }
    return sum.a > 0.0 ? vec4(sum.rgb / sum.a, 1.0) : vec4(0.0);
}

// quads: that are derived. newer: whose former light is out of date.
void noteDerived(LitObject object, uint index, uint quads, uint newer, uint youngest, uint childIndex, bool waited)
{
    uint held = object.tiles.at[index].held, derived = held >> 16u;
    held = (held & kAllQuads & ~quads) | (((derived & ~newer) | quads) << 16u);
    object.tiles.at[index].held = held;
    object.tiles.at[index].derived = youngest;
    if ((held & kAllQuads) == 0u) { // all that is known of its light is its child's
        TileState child = lightState(object, childIndex);
        object.tiles.at[index].lit = youngest;
        object.tiles.at[index].eye = child.eye;
        object.tiles.at[index].centre = child.centre;
        object.tiles.at[index].radius = 2.0 * child.radius;
        object.tiles.at[index].rates = packHalf2x16(vec2(kTurnedOfDerived, rateOf(child.rates, child.change)));
        object.tiles.at[index].change = 0u;
    }
    if (object.tiles.at[index].shown == 0u)
        object.tiles.at[index].shown = waited ? view.frame : kShownAtOnce;
}

// What is to be done to a tile.
struct Work {
    uint object, place;
    uint quads; // to be derived; in the high half those to be emptied: their light must not be drawn
    uint whole; // quads that surface covers
};
shared Work found[kLowerTiles];

// Of the quads that the view needs, those whose children are newer. Notes that they are derived.
Work look(Tile tile, uint mip, uint needed, uint wrong)
{
    LitObject object = litObject(tile.object);
    uvec2 place = placeTile(tile.place), ratio = mipSize(object, mip - 1u) / mipSize(object, mip);
    uint index = tileIndex(object, mip, place);
    Children children = childrenOf(object, mip, place, object.tiles.at[index].derived);
    uint quads = needed & children.held & (children.newer | ~(object.tiles.at[index].held >> 16u));
    if ((quads | wrong) != 0u) {
        noteDerived(object, index, quads, children.newer | wrong, children.youngest,
                    tileIndex(object, mip - 1u, place * ratio), (tile.place & kPlaceWaited) != 0u);
        atomicAdd(push.plan.at.quadsDerived, bitCount(quads));
    }
    return Work(tile.object, packPlace(mip, place), quads | (wrong & ~quads) << 16u, wholeQuads(object, mip, place));
}

// By all lanes.
void deriveTile(Work work)
{
    LitObject object = litObject(work.object);
    uint mip = placeMip(work.place), quads = work.quads & kAllQuads, changed = quads | work.quads >> 16u;
    Source source = Source(mipOf(object, mip - 1u), mipOf(object, mip),
                           mipSize(object, mip - 1u) / mipSize(object, mip), object.texels, 0u, object.layer);
    source.tileTexels = tileTexelsOf(source, source.coarse, placeTile(work.place) * kTileSize);
    uint local = gl_LocalInvocationIndex, count = bitCount(changed);
    for (uint i = local / kQuadLumels; i < count;) {
        uint quad = quadOf(changed, i);
        uvec2 lumel = placeTile(work.place) * kTileSize + lumelOf(quad, local % kQuadLumels);
        bool whole = (work.whole >> quad & 1u) != 0u;
        vec4 light = (quads >> quad & 1u) != 0u ? derive(source, min(lumel, source.coarse.size - 1u), whole) : vec4(0.0);
        if (all(lessThan(lumel, source.coarse.size)))
            imageStore(lit, ivec3(source.coarse.origin + lumel, source.layer), light);
        i += gl_WorkGroupSize.x / kQuadLumels;
        if (i >= count)
            break;
    }
}

// Tiles of one MIP, from `first` of the job's list on.
void deriveTiles(Job job, uint first)
{
    uint local = gl_LocalInvocationIndex, count = min(listed(job) - first, kTilesAtOnce);
    if (local < count) {
        JobTile entry = push.tiles.at[job.first + first + local];
        found[local] = look(entry.tile, placeMip(entry.tile.place), entry.quads & kAllQuads, entry.quads >> 16u);
    }
    barrier();
    uint changed = 0u;
    for (uint i = 0u; i < kTilesAtOnce; ++i)
        changed |= i < count && found[i].quads != 0u ? 1u << i : 0u;
    for (; changed != 0u;) {
        deriveTile(found[findLSB(changed)]);
        changed &= changed - 1u;
        if (changed == 0u)
            break;
    }
    barrier(); // all have read what was found
}

// An object's tail, whose MIPs are a tile each. The view needs all of those that follow from its first.
void deriveTail(JobTile entry)
{
    LitObject object = litObject(entry.tile.object);
    uint needed = entry.quads & kAllQuads, wrong = entry.quads >> 16u;
    for (uint mip = placeMip(entry.tile.place);;) {
        if (gl_LocalInvocationIndex == 0u)
            found[0] = look(entry.tile, mip, needed, wrong);
        barrier();
        deriveTile(found[0]);
        memoryBarrierImage();
        memoryBarrierBuffer();
        barrier(); // the next MIP is made of this one
        if (++mip >= object.mips)
            break;
        needed = surfaceQuads(object, mip, uvec2(0u));
        wrong = 0u;
    }
}

void main()
{
    Job job = push.jobs.at[push.job];
    uint i = gl_WorkGroupID.x * kTilesAtOnce, count = listed(job);
    do {
        if (kTail)
            deriveTail(push.tiles.at[job.first + i]);
        else
            deriveTiles(job, i);
        i += gl_NumWorkGroups.x * kTilesAtOnce;
    } while (i < count);
}
