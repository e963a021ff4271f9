#version 460
#extension GL_GOOGLE_include_directive : require
// Plan, third step: which of the marked tiles are lit within the frame's budget? They enter a list of their own, so that
// the next step's invocations are all busy.
#include "lib/plan.glsl"

layout(local_size_x = 64) in;
layout(constant_id = 3) const uint kLanes = 64u; // of bound.comp

// Uniform in [0, 1) by tile and frame: which tiles of the threshold's priority are lit does not depend on the
// order in which they were marked. (Wellons 2018, "Prospecting for Hash Functions", lowbias32.)
float chance(Tile tile, uint frame)
{
    uint x = tile.place ^ (tile.object * 0x9e3779b9u) ^ (frame * 0x85ebca6bu);
    x = (x ^ (x >> 16u)) * 0x7feb352du;
    x = (x ^ (x >> 15u)) * 0x846ca68bu;
    return float((x ^ (x >> 16u)) >> 8u) / 16777216.0;
}

// The ball found when the tile was last lit holds until its object moves; a derived tile's is a guess.
bool isBound(LitObject object, uint index)
{
    uint lit = object.tiles.at[index].lit;
    return lit != 0u && object.changed <= lit &&
           unpackHalf2x16(object.tiles.at[index].rates).x != kTurnedOfDerived;
}

void main()
{
    uint listed = listIndex();
    if (listed >= push.plan.at.marked)
        return;
    Mark mark = push.marks.at[listed];
    LitObject object = litObject(mark.tile.object);
    uint index = tileIndex(object, placeMip(mark.tile.place), placeTile(mark.tile.place));
    push.marks.at[listed].tile.place |= kPlaceWaited; // if they serve another frame
    if (mark.verdict >= kPriorities)
        return;
    uint threshold = push.plan.at.threshold;
    if (mark.verdict > threshold ||
        (mark.verdict == threshold && chance(mark.tile, view.frame) < push.plan.at.share)) {
        uint slot = atomicAdd(push.plan.at.chosen, 1u);
        if (slot % 64u == 0u)
            atomicAdd(push.plan.at.chosenGroups[0], 1u);
        push.marks.at[push.markCapacity + slot] = mark;
        if (!isBound(object, index)) {
            uint unbound = atomicAdd(push.plan.at.unbound, 1u);
            if (unbound % kLanes == 0u && unbound / kLanes < kMaxJobGroups)
                atomicAdd(push.plan.at.unboundGroups[0], 1u);
            push.marks.at[2u * push.markCapacity + unbound] = mark;
        }
    } else {
        atomicAdd(push.plan.at.quadsPending, bitCount(mark.quads & kAllQuads));
    }
}
