#version 460
#extension GL_GOOGLE_include_directive : require
// Plan, second step: what happens to each marked quad? It is derived when the view needs its four children too; a
// tile's others are kept when lighting them again would change too little, else lit, with a priority.
#include "lib/plan.glsl"
#include "shared/shading.h"

layout(local_size_x = 64) in;

const bool kMayWait = (kFeatures & kFeatureWaiting) != 0u; // the frame has a budget of lumels

// Display change per radian that is expected of any tile: even a matte one is relit occasionally.
const float kLeastRate = 0.02;
// Radians that the eye may turn around a tile before its light counts as another view's: after a camera cut,
// nothing of the previous view may be seen.
const float kCutAngle = 0.2;

// The object has changed since a frame, or a light that may reach the tile.
bool changedSince(LitObject object, TileState tile, uint since)
{
    if (object.changed > since)
        return true;
    bool changed = false;
    for (uint i = view.lightsChanged > since ? 0u : view.lightCount; i < view.lightCount;) {
        changed = lights[i].changed > since && lightReaches(lights[i], tile.centre, tile.radius);
        if (changed || ++i == view.lightCount)
            break;
    }
    return changed;
}

// Largest rate among the tile and its neighbours: a highlight enters a matte tile from its neighbour.
float rateAround(LitObject object, uint mip, uvec2 tile, TileState state)
{
    ivec2 last = ivec2(tileCount(mipSize(object, mip))) - 1;
    float rate = max(kLeastRate, rateOf(state.rates, state.change));
    ivec2 steps[4] = ivec2[](ivec2(-1, 0), ivec2(1, 0), ivec2(0, -1), ivec2(0, 1));
    for (int i = 0; i < 4; ++i) {
        uvec2 beside = uvec2(clamp(ivec2(tile) + steps[i], ivec2(0), last));
        uint index = tileIndex(object, mip, beside);
        rate = max(rate, rateOf(object.tiles.at[index].rates, object.tiles.at[index].change));
    }
    return rate;
}

// Of a tile's quads, those to be derived from the finer MIP. Within a budget the children may have to wait, and
// something must be shown meanwhile: a quad without light is derived from what holds light only.
uint derivedQuads(LitObject object, uint mip, uvec2 tile, uint quads, TileState state)
{
    if (mip == 0u || (kMayWait && state.held == 0u && mip == tailMip(object.mips)))
        return 0u;
    uint derived = quads & quadsNeededFiner(object, mip, tile, push.marking);
    if (kMayWait)
        derived &= childrenOf(object, mip, tile, 0u).held | state.held | state.held >> 16u;
    return derived;
}

// Derived quads that the view does not need, and whose light is wrong: drawn nevertheless where no sample saw the need,
// they would show it.
uint wrongQuads(LitObject object, TileState state, uint needed)
{
    uint others = state.held >> 16u & ~needed;
    if (others == 0u)
        return 0u;
    return changedSince(object, state, state.derived) ? others : 0u;
}

struct Verdict {
    uint priority; // or kVerdictKeep
    uint quads;    // as in Mark
};

// What happens to those of a tile's quads that are not derived?
Verdict judge(LitObject object, uint mip, uvec2 tile, uint quads, TileState state)
{
    if (kMayWait && state.held == 0u && mip == tailMip(object.mips))
        return Verdict(kPriorityAlways, quads);
    uint unlit = kPriorityChanged + 1u + min(mip, kPriorityAlways - kPriorityChanged - 2u);
    uint held = state.held | state.held >> 16u;
    if (held == 0u) // coarse tiles first: they cover more
        return Verdict(unlit, quads);
    if ((quads & held & ~state.held) != 0u)
        state.lit = min(state.lit, state.derived);
    if (changedSince(object, state, state.lit))
        return Verdict(kPriorityChanged, quads);
    float angle = turnedSince(state, view.eyeInWorld);
    float change = angle > 1e-5 ? angle * rateAround(object, mip, tile, state) : 0.0;
    if (change > push.tolerance)
        return Verdict(angle > kCutAngle ? kPriorityChanged
                                         : min(uint(4.0 * log2(change / push.tolerance)), kPriorityChanged - 1u),
                       quads);
    uint more = quads & ~held;
    if (more == 0u)
        return Verdict(kVerdictKeep, quads);
    bool isLit = (state.held & kAllQuads) != 0u; // of a derived tile it is not known where it lies
    return Verdict(unlit, isLit ? more | kMarkMore : quads);
}

void main()
{
    uint index = listIndex();
    if (index >= push.plan.at.marked)
        return;
    Tile tile = push.marks.at[index].tile;
    LitObject object = litObject(tile.object);
    uint mip = placeMip(tile.place);
    uvec2 place = placeTile(tile.place);
    uint stateIndex = tileIndex(object, mip, place);
    uint quads = quadsNeeded(object, stateIndex, push.marking) & surfaceQuads(object, mip, place);
    TileState state = lightState(object, stateIndex);
    uint derived = derivedQuads(object, mip, place, quads, state);
    uint tail = derivedTail(object.mips);
    if ((derived != 0u && mip < tail) || mip == tail) // the tail's coarser MIPs follow from its first
        append(object.lowerJob + mip - 1u, tile, derived | wrongQuads(object, state, quads) << 16u,
               mip < tail ? kLowerTiles : 1u);
    uint lit = quads & ~derived;
    Verdict verdict = lit == 0u ? Verdict(kVerdictNone, 0u) : judge(object, mip, place, lit, state);
    push.marks.at[index].verdict = verdict.priority;
    push.marks.at[index].quads = verdict.quads;
    atomicAdd(push.plan.at.quadsMarked, bitCount(quads));
    if (verdict.priority < kPriorities)
        atomicAdd(push.plan.at.histogram[verdict.priority], bitCount(verdict.quads & kAllQuads));
}
