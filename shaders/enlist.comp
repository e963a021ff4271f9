#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#extension GL_KHR_shader_subgroup_basic : require
// Plan, last step: the tiles to be lit enter the lists of their jobs, with their place in the surface cache and the lights
// that reach them.
#include "lib/geometry.glsl"
#include "lib/plan.glsl"
#include "shared/shading.h"

layout(local_size_x = 64) in;

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

// Centre and radius (w) of a ball around the tile's surface, unless the known one holds: from its corners and centre
// where all lie on it, else from every lumel.
vec4 ballOf(LitObject object, ObjectAt mesh, uint mip, uvec2 tile, vec4 known, bool holds)
{
    uint level = object.litLevel + mip;
    uvec2 last = min(mipSize(object, mip), uvec2(kTileSize)) - 1u;
    vec3 lower = vec3(1e30), upper = vec3(-1e30);
    uint found = 0u;
    for (uint i = holds ? 5u : 0u; i < 5u;) {
        uvec2 step = i == 4u ? last / 2u : last * uvec2(i & 1u, i >> 1u);
        vec4 p = positionOf(object, mesh, level, tile * kTileSize + step);
        found += uint(p.w);
        lower = min(lower, p.w > 0.0 ? p.xyz : lower);
        upper = max(upper, p.w > 0.0 ? p.xyz : upper);
        if (++i == 5u)
            break;
    }
    for (uint i = holds || found == 5u ? kTileLumels : 0u; i < kTileLumels;) {
        uvec2 step = min(uvec2(i % kTileSize, i / kTileSize), last);
        vec4 p = positionOf(object, mesh, level, tile * kTileSize + step);
        lower = min(lower, p.w > 0.0 ? p.xyz : lower);
        upper = max(upper, p.w > 0.0 ? p.xyz : upper);
        if (++i == kTileLumels)
            break;
    }
    const float kBulge = 1.25; // of a curved surface between its corners
    vec4 ball = vec4(0.5 * (lower + upper), 0.5 * kBulge * length(max(upper - lower, vec3(0.0))));
    return holds ? known : ball;
}

// All quads that a tile needs are about to be lit: notes from where.
void noteLighting(LitObject object, uint index, Tile tile, uint quads, TileState state)
{
    bool known = state.lit != 0u && ((state.held | state.held >> 16u) & quads) != 0u;
    // The ball found when the tile was last lit holds until the object moves; a derived tile's is a guess.
    bool ballHolds = state.lit != 0u && state.turned != kTurnedOfDerived && object.changed <= state.lit;
    vec4 ball = ballOf(object, objectAt(tile.object), placeMip(tile.place), placeTile(tile.place),
                       vec4(state.centre, state.radius), ballHolds);
    if (known)
        object.tiles.at[index].rate = rateOf(state);
    object.tiles.at[index].turned = known ? max(turnedSince(state, view.eyeInWorld), 1e-6) : 0.0;
    object.tiles.at[index].change = 0u;
    object.tiles.at[index].eye = view.eyeInWorld;
    object.tiles.at[index].centre = ball.xyz;
    object.tiles.at[index].radius = ball.w;
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
    SurfaceCacheState cache = push.surfaces;
    bool holds = state.surface > cache.oldest && object.changed <= state.checked &&
                 cache.latest - state.surface < cache.capacity - surfacesAFrame(cache.capacity);
    if (holds)
        return state.surface;
    bool moves = (objectFlags(object) & kObjectDeformed) != 0u || object.changed + kRestFrames > view.frame;
    if (moves || cache.capacity == 0u)
        return 0u;
    uint taken = atomicAdd(push.plan.at.surfacesTaken, 1u);
    return taken < surfacesAFrame(cache.capacity) ? cache.latest + taken + 1u : 0u;
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
    uint slot = append(job, mark.tile, quads | (more ? 0u : holding << 16u));
    if (slot == kListFull)
        return false;
    if (more)
        object.tiles.at[index].held = (state.held | quads) & ~(quads << 16u);
    else
        noteLighting(object, index, mark.tile, quads, state);
    vec4 ball = vec4(object.tiles.at[index].centre, object.tiles.at[index].radius);
    listLights(ball.xyz, ball.w, slot);
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
