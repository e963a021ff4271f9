#version 460
#extension GL_GOOGLE_include_directive : require
// Plan, second step: what happens to each marked tile? Derive it from its four children when all are
// marked; keep it when lighting it again would change too little; else light it, with a priority.
#include "lib/rows.glsl"
#include "lib/tiles.glsl"
#include "shared/shading.h"

layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Constants { PlanPush push; };

// Display change per radian that is expected of any tile: even a matte one is relit occasionally.
const float kLeastRate = 0.02;
// Radians that the eye may turn around a tile before its light counts as another view's: after a camera cut,
// nothing of the previous view may be seen.
const float kCutAngle = 0.2;

// Can the tile be derived: are its four children all marked? `litToo`: and do they all hold light already?
bool childrenServe(ObjectAt object, uint mip, uvec2 tile, bool litToo)
{
    if (mip == 0u)
        return false;
    uvec2 fine = tileCount(mipSize(object, mip - 1u));
    uvec2 ratio = mipSize(object, mip - 1u) / mipSize(object, mip);
    for (uint i = 0u; i < 4u; ++i) {
        uvec2 child = tile * ratio + uvec2(i & 1u, i >> 1u);
        if (any(greaterThanEqual(child, fine)) || tileEmpty(object, mip - 1u, child))
            continue;
        uint index = tileIndex(object, mip - 1u, child);
        if (object.at.tiles.at[index].marked != view.frame || (litToo && object.at.tiles.at[index].lit == 0u))
            return false;
    }
    return true;
}

// A light that changed since the tile was lit, and may reach it.
bool lightChanged(TileState tile)
{
    for (uint i = 0u; i < view.lightCount; ++i)
        if (lights[i].changed > tile.lit && lightReaches(lights[i], tile.centre, tile.radius))
            return true;
    return false;
}

// Largest rate among the tile and its neighbours: a highlight enters a matte tile from its neighbour.
float rateAround(ObjectAt object, uint mip, uvec2 tile)
{
    ivec2 last = ivec2(tileCount(mipSize(object, mip))) - 1;
    float rate = max(kLeastRate, rateOf(lightState(object, tileIndex(object, mip, tile))));
    ivec2 steps[4] = ivec2[](ivec2(-1, 0), ivec2(1, 0), ivec2(0, -1), ivec2(0, 1));
    for (int i = 0; i < 4; ++i) {
        uvec2 beside = uvec2(clamp(ivec2(tile) + steps[i], ivec2(0), last));
        TileState state = lightState(object, tileIndex(object, mip, beside));
        if (state.lit != 0u)
            rate = max(rate, rateOf(state));
    }
    return rate;
}

uint judge(ObjectAt object, uint mip, uvec2 tile)
{
    if (tileEmpty(object, mip, tile))
        return kVerdictEmpty;
    TileState state = lightState(object, tileIndex(object, mip, tile));
    // Within a budget the children may have to wait, and something must be shown meanwhile.
    bool waits = state.lit == 0u && push.budgetTiles < ~0u / kTileLumels;
    if (waits && mip == tailMip(object.at.mips))
        return kPriorityAlways;
    if (childrenServe(object, mip, tile, waits))
        return kVerdictDerive;
    if (state.lit == 0u) // coarse tiles first: they cover more
        return kPriorityChanged + 1u + min(mip, kPriorityAlways - kPriorityChanged - 2u);
    if (object.at.changed > state.lit || lightChanged(state))
        return kPriorityChanged;
    float angle = turnedSince(state, view.eyeInWorld);
    float change = angle > 1e-5 ? angle * rateAround(object, mip, tile) : 0.0;
    if (change <= push.tolerance)
        return kVerdictKeep;
    if (angle > kCutAngle)
        return kPriorityChanged;
    return min(uint(4.0 * log2(change / push.tolerance)), kPriorityChanged - 1u);
}

void main()
{
    uint index = listIndex();
    if (index >= push.plan.at.marked)
        return;
    Tile tile = push.marks.at[index].tile;
    ObjectAt object = objectAt(tile.object);
    uint verdict = judge(object, placeMip(tile.place), placeTile(tile.place));
    push.marks.at[index].verdict = verdict;
    uint bits = (verdict == kVerdictDerive ? kDeriveFromChildren : 0u) |
                ((tile.place & kPlaceWaited) != 0u ? kDeriveWaited : 0u);
    uint state = tileIndex(object, placeMip(tile.place), placeTile(tile.place));
    object.at.tiles.at[state].derive = view.frame << kDeriveBits | bits;
    if (verdict < kPriorities)
        atomicAdd(push.plan.at.histogram[verdict], 1u);
}
