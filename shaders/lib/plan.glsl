// The plan's push constants, and the lists that its steps fill.
#ifndef LUMEL_PLAN_GLSL
#define LUMEL_PLAN_GLSL
#include "lib/rows.glsl"
#include "lib/tiles.glsl"

layout(push_constant, scalar) uniform Constants { PlanPush push; };

// tilesAGroup: how many a group of the job's dispatch takes together. Returns the tile's place in the list of all jobs'
// tiles, kListFull when the job's is full.
const uint kListFull = ~0u;
uint append(uint job, Tile tile, uint quads, uint tilesAGroup)
{
    uint slot = atomicAdd(push.jobs.at[job].count, 1u);
    if (slot >= push.jobs.at[job].capacity) {
        atomicAdd(push.plan.at.dropped, 1u);
        return kListFull;
    }
    if (slot % tilesAGroup == 0u && slot / tilesAGroup < kMaxJobGroups)
        atomicMax(push.jobs.at[job].groups[0], slot / tilesAGroup + 1u);
    slot += push.jobs.at[job].first;
    push.tiles.at[slot].tile = tile;
    push.tiles.at[slot].quads = quads;
    return slot;
}
#endif
