#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#extension GL_KHR_shader_subgroup_basic : require
// Plan, last step: the tiles to be lit enter the lists of their jobs, with their place in the surface cache and the lights
// that reach them.
#include "lib/plan.glsl"
#include "shared/shading.h"

layout(local_size_x = 64) in;

// All quads that a tile needs are about to be lit: notes from where.
void noteLighting(LitObject object, uint index, Tile tile, uint quads, TileState state)
{
    bool known = state.lit != 0u && ((state.held | state.held >> 16u) & quads) != 0u;
    vec2 turnedAndRate = vec2(max(turnedSince(state, view.eyeInWorld), 1e-4), rateOf(state.rates, state.change));
    object.tiles.at[index].rates = known ? packHalf2x16(turnedAndRate) : ratesOfFirst();
    object.tiles.at[index].change = 0u;
    object.tiles.at[index].eye = view.eyeInWorld;
    object.tiles.at[index].lit = view.frame;
    object.tiles.at[index].held = quads | (state.held & ~kAllQuads & ~(quads << 16u));
    if (state.shown == 0u)
        object.tiles.at[index].shown = (tile.place & kPlaceWaited) != 0u ? view.frame : kShownAtOnce;
}

// Which lights reach the tile.
void listLights(vec3 centre, float radius, uint slot)
{
    uint bits = 0u, count = min(view.lightCount, kListedLights);
    for (uint i = 0u; i < count;) {
        bits |= lightReaches(lights[i], centre, radius) ? 1u << i % 32u : 0u;
        ++i;
        if (i % 32u == 0u || i == count) {
            push.tiles.at[slot].lights[(i - 1u) / 32u] = bits;
            bits = 0u;
        }
        if (i == count)
            break;
    }
}

// Those of them that have a shadow map: bit i is the light of view.shadows[i], bit 8 + i that it has changed since.
uint shadowsReaching(uint slot, uint since)
{
    uint shadows = 0u;
    for (uint i = 0u; i < view.shadowCount;) {
        uint light = view.shadows[i].light, bit = (push.tiles.at[slot].lights[light / 32u] >> light % 32u & 1u) << i;
        shadows |= bit | (lights[light].changed > since ? bit << kMaxShadows : 0u);
        if (++i == view.shadowCount)
            break;
    }
    return shadows;
}

// No light with a shadow map has changed since, nor what casts its shadows.
bool shadowsUnchanged(uint since)
{
    uint latest = 0u;
    for (uint i = view.lightsChanged > since ? 0u : view.shadowCount; i < view.shadowCount;) {
        latest = max(latest, lights[view.shadows[i].light].changed);
        if (++i == view.shadowCount)
            break;
    }
    return latest <= since;
}

// Frames after which what moved counts as at rest.
const uint kRestFrames = 4u;

// A tile's place in the surface cache: its own while that holds, else a new one if it is to have any.
uint surfaceNumber(LitObject object, TileState state)
{
    uint capacity = push.surfaces.capacity, latest = push.plan.at.surfacesLatest;
    uint age = latest - state.surface; // numbers wrap around
    bool holds = state.surface != 0u && age < latest - push.plan.at.surfacesOldest &&
                 age < capacity - surfacesAFrame(capacity) && object.changed <= state.checked;
    if (holds)
        return state.surface;
    uint flags = objectFlags(object);
    bool moves = (flags & kObjectDeformed) != 0u || object.changed + kRestFrames > view.frame;
    if (moves || capacity == 0u)
        return 0u;
    uint pages = surfacePages(flags), taken = atomicAdd(push.plan.at.surfacesTaken, pages);
    return taken + pages <= surfacesAFrame(capacity) ? latest + taken + 1u : 0u;
}

// Enters the quads in the list of a job; false when that is full.
bool light(LitObject object, uint index, Mark mark)
{
    TileState state = lightState(object, index);
    uint quads = mark.quads & kAllQuads, holding = (state.held | state.held >> 16u) & quads;
    bool more = (mark.quads & kMarkMore) != 0u;
    uint surface = surfaceNumber(object, state);
    uint known = surface != 0u && surface == state.surface ? state.cached : 0u;
    uint job = object.lightJob;
    if ((quads & ~known) == 0u) {
        bool shadowsKnown = (quads & ~(known >> 16u)) == 0u && shadowsUnchanged(state.checked);
        job = object.cachedJob + (shadowsKnown || view.shadowCount == 0u ? 0u : 1u);
    }
    uint slot = append(job, mark.tile, quads | (more ? 0u : holding << 16u), 1u);
    if (slot == kListFull)
        return false;
    if (more)
        object.tiles.at[index].held = (state.held | quads) & ~(quads << 16u);
    else
        noteLighting(object, index, mark.tile, quads, state);
    listLights(state.centre, state.radius, slot);
    uint shadows = shadowsReaching(slot, state.checked), visible = known >> 16u;
    if (shadows >> kMaxShadows != 0u)
        visible &= quads; // that of the others is found again when they are lit
    push.tiles.at[slot].surface = surface;
    // Where the eye alone has moved, old light is better than none.
    uint wrong = mark.verdict == kPriorityChanged ? state.held & kAllQuads & ~quads : 0u;
    push.tiles.at[slot].visible = visible | wrong << 16u;
    push.tiles.at[slot].shadows = shadows;
    object.tiles.at[index].surface = surface;
    object.tiles.at[index].cached = surface != 0u ? (known & kAllQuads) | quads | (visible | quads) << 16u : 0u;
    object.tiles.at[index].checked = view.frame;
    return true;
}

void main()
{
    uint chosen = listIndex();
    if (chosen >= push.plan.at.chosen)
        return;
    Mark mark = push.marks.at[push.markCapacity + chosen];
    LitObject object = litObject(mark.tile.object);
    uint index = tileIndex(object, placeMip(mark.tile.place), placeTile(mark.tile.place));
    bool isLit = light(object, index, mark);
    uint quads = bitCount(mark.quads & kAllQuads);
    uint tiles = subgroupAdd(isLit ? 1u : 0u), lit = subgroupAdd(isLit ? quads : 0u), all = subgroupAdd(quads);
    if (subgroupElect()) {
        atomicAdd(push.plan.at.tilesLit, tiles);
        atomicAdd(push.plan.at.quadsLit, lit);
        atomicAdd(push.plan.at.quadsPending, all - lit);
    }
}
