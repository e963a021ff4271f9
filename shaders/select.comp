#version 460
#extension GL_GOOGLE_include_directive : require
// Plan, last step: the tiles to light and to derive enter the lists of their jobs.
#include "lib/geometry.glsl"
#include "lib/rows.glsl"
#include "lib/tiles.glsl"
#include "shared/shading.h"

layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Constants { PlanPush push; };

// Uniform in [0, 1) by tile and frame: which tiles of the threshold's priority are lit does not depend on the
// order in which they were marked. (Wellons 2018, "Prospecting for Hash Functions", lowbias32.)
float chance(Tile tile, uint frame)
{
    uint x = tile.place ^ (tile.object * 0x9e3779b9u) ^ (frame * 0x85ebca6bu);
    x = (x ^ (x >> 16u)) * 0x7feb352du;
    x = (x ^ (x >> 15u)) * 0x846ca68bu;
    return float((x ^ (x >> 16u)) >> 8u) / 16777216.0;
}

// Returns the tile's place in the list, kListFull when that is full.
const uint kListFull = ~0u;
uint append(uint job, Tile tile)
{
    uint slot = atomicAdd(push.jobs.at[job].count, 1u);
    if (slot >= push.jobs.at[job].capacity) {
        atomicAdd(push.plan.at.dropped, 1u);
        return kListFull;
    }
    if (slot < kMaxJobGroups)
        atomicMax(push.jobs.at[job].groups[0], slot + 1u);
    slot += push.jobs.at[job].first;
    push.tiles.at[slot].tile = tile;
    return slot;
}

// World position of a lumel's point on the surface; w = 0 where there is none.
vec4 positionOf(ObjectAt object, uint level, uvec2 lumel)
{
    uint triangle = texelAt(object, level, lumel) & kTexelTriangleMask;
    if (triangle == 0u)
        return vec4(0.0);
    Vertex a = pullVertex(object, 3u * triangle - 3u);
    Vertex b = pullVertex(object, 3u * triangle - 2u);
    Vertex c = pullVertex(object, 3u * triangle - 1u);
    vec2 size = vec2(max(object.at.litSize >> level, uvec2(1u)));
    vec3 w = barycentrics(a.uv, b.uv, c.uv, (vec2(lumel) + 0.5) / size);
    vec3 position = w.x * a.position + w.y * b.position + w.z * c.position;
    return vec4((object.at.worldFromObject * vec4(position, 1.0)).xyz, 1.0);
}

// Centre and radius (w) of a ball around the tile's surface: from its corners and centre where all lie on it,
// else from every lumel.
vec4 ballOf(ObjectAt object, uint mip, uvec2 tile)
{
    uint level = object.at.litLevel + mip;
    uvec2 last = min(mipSize(object, mip), uvec2(kTileSize)) - 1u;
    vec3 lower = vec3(1e30), upper = vec3(-1e30);
    uint found = 0u;
    for (uint i = 0u; i < 5u; ++i) {
        uvec2 step = i == 4u ? last / 2u : last * uvec2(i & 1u, i >> 1u);
        vec4 p = positionOf(object, level, tile * kTileSize + step);
        found += uint(p.w);
        lower = min(lower, p.w > 0.0 ? p.xyz : lower);
        upper = max(upper, p.w > 0.0 ? p.xyz : upper);
    }
    for (uint i = 0u; i < (found < 5u ? kTileLumels : 0u); ++i) {
        uvec2 step = uvec2(i % kTileSize, i / kTileSize);
        if (any(greaterThan(step, last)))
            continue;
        vec4 p = positionOf(object, level, tile * kTileSize + step);
        lower = min(lower, p.w > 0.0 ? p.xyz : lower);
        upper = max(upper, p.w > 0.0 ? p.xyz : upper);
    }
    const float kBulge = 1.25; // of a curved surface between its corners
    return vec4(0.5 * (lower + upper), 0.5 * kBulge * length(max(upper - lower, vec3(0.0))));
}

// A tile's light changes: what is derived from it, and so on, enters the lists of jobs, each tile once. The tail's
// MIPs enter as one.
void queueDerived(ObjectAt object, uint objectIndex, uint mip, uvec2 tile)
{
    for (; mip < object.at.mips; ++mip) {
        uvec2 size = mipSize(object, mip);
        uint index = tileIndex(object, mip, tile);
        uint derive = object.at.tiles.at[index].derive;
        if (derive >> kDeriveBits != view.frame || (derive & kDeriveFromChildren) == 0u)
            return;
        if ((atomicOr(object.at.tiles.at[index].derive, kDeriveQueued) & kDeriveQueued) != 0u)
            return;
        uvec2 lumels = min(size, uvec2(kTileSize));
        atomicAdd(push.plan.at.lumelsDerived, lumels.x * lumels.y);
        uint tail = derivedTail(object.at.mips);
        if (mip < tail)
            append(object.at.lowerJob + mip - 1u, Tile(objectIndex, packPlace(mip, tile)));
        else if ((atomicOr(object.at.tiles.at[object.at.tileOffsets[tail]].derive, kDeriveTail) & kDeriveTail) == 0u)
            append(object.at.lowerJob + tail - 1u, Tile(objectIndex, packPlace(tail, uvec2(0u))));
        tile /= size / max(size >> 1u, uvec2(1u));
    }
}

// The tile is about to be lit: notes from where, and which lights reach it. Member by member: other invocations
// may be changing `derive`.
void prepare(ObjectAt object, Tile tile, uint slot)
{
    uint index = tileIndex(object, placeMip(tile.place), placeTile(tile.place));
    TileState state = lightState(object, index);
    bool known = state.lit != 0u;
    // The ball found when the tile was last lit holds until the object moves; a derived tile's is a guess. A loop,
    // because software Vulkan runs both sides of a branch.
    vec4 ball = vec4(state.centre, state.radius);
    bool ballHolds = known && state.turned != kTurnedOfDerived && object.at.changed <= state.lit;
    for (uint once = ballHolds ? 1u : 0u; once < 1u; ++once)
        ball = ballOf(object, placeMip(tile.place), placeTile(tile.place));
    if (known)
        object.at.tiles.at[index].rate = rateOf(state);
    object.at.tiles.at[index].turned = known ? max(turnedSince(state, view.eyeInWorld), 1e-6) : 0.0;
    object.at.tiles.at[index].change = 0u;
    object.at.tiles.at[index].eye = view.eyeInWorld;
    object.at.tiles.at[index].centre = ball.xyz;
    object.at.tiles.at[index].radius = ball.w;
    object.at.tiles.at[index].lit = view.frame;
    if (state.shown == 0u)
        object.at.tiles.at[index].shown = (tile.place & kPlaceWaited) != 0u ? view.frame : kShownAtOnce;
    for (uint word = 0u; word < kListedLights / 32u && 32u * word < view.lightCount; ++word) {
        uint bits = 0u;
        for (uint i = 0u; i < min(view.lightCount - 32u * word, 32u); ++i)
            bits |= lightReaches(lights[32u * word + i], ball.xyz, ball.w) ? 1u << i : 0u;
        push.tiles.at[slot].lights[word] = bits;
    }
}

void main()
{
    uint index = listIndex();
    if (index >= push.plan.at.marked)
        return;
    Mark mark = push.marks.at[index];
    ObjectAt object = objectAt(mark.tile.object);
    uint mip = placeMip(mark.tile.place);
    uvec2 size = min(mipSize(object, mip), uvec2(kTileSize));
    uint lumels = size.x * size.y;
    if (mark.verdict == kVerdictEmpty)
        return;
    atomicAdd(push.plan.at.lumelsMarked, lumels);
    uvec2 tile = placeTile(mark.tile.place);
    if (mark.verdict == kVerdictDerive) {
        // Children that were lit in earlier frames; those lit in this one queue it themselves.
        if (childrenLit(object, mip, tile) > object.at.tiles.at[tileIndex(object, mip, tile)].lit)
            queueDerived(object, mark.tile.object, mip, tile);
    } else if (mark.verdict < kPriorities) {
        uint threshold = push.plan.at.threshold;
        bool chosen = mark.verdict > threshold ||
                      (mark.verdict == threshold && chance(mark.tile, view.frame) < push.plan.at.share);
        uint slot = chosen ? append(object.at.lightJob, mark.tile) : kListFull;
        if (slot != kListFull) {
            prepare(object, mark.tile, slot);
            uvec2 ratio = mipSize(object, mip) / max(mipSize(object, mip) >> 1u, uvec2(1u));
            queueDerived(object, mark.tile.object, mip + 1u, tile / ratio);
            atomicAdd(push.plan.at.tilesLit, 1u);
            atomicAdd(push.plan.at.lumelsLit, lumels);
        } else {
            atomicAdd(push.plan.at.lumelsPending, lumels);
        }
    }
}
