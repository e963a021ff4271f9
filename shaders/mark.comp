#version 460
#extension GL_GOOGLE_include_directive : require
// Plan, first step: every sample of the feedback pass marks the tiles that drawing its block of pixels will read,
// at the two MIPs that it blends and, as a fallback, three MIPs coarser. Every object's tail
// MIPs are marked too. A tile enters the list the first time it is marked in a frame.
#include "lib/footprint.glsl"
#include "lib/rows.glsl"
#include "lib/tiles.glsl"

layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Constants { PlanPush push; };
layout(set = 1, binding = 0, rgba32ui) uniform readonly uimage2D seen;

const int kWidest = 8;              // tiles along either axis that one sample may mark
const float kLevelMargin = 0.1;     // the pixels of a block differ in level
const uint kFallback = 3u;          // MIPs

void mark(ObjectAt object, uint objectIndex, uint mip, uvec2 tile, uint frame)
{
    uint index = tileIndex(object, mip, tile);
    // Reading first spares most atomics.
    if (object.at.tiles.at[index].marked == frame)
        return;
    uint before = atomicExchange(object.at.tiles.at[index].marked, frame);
    if (before == frame)
        return;
    uint slot = atomicAdd(push.plan.at.marked, 1u);
    if (slot >= push.markCapacity) {
        atomicExchange(object.at.tiles.at[index].marked, before); // coarser tiles may not rely on its light
        atomicAdd(push.plan.at.dropped, 1u);
        return;
    }
    push.marks.at[slot] = Mark(Tile(objectIndex, packPlace(mip, tile) | (before != 0u && before + 1u == frame ? kPlaceWaited : 0u)), 0u);
}

// The tiles within `reach` of the parallelogram that the sample's block of pixels covers.
void markBlock(ObjectAt object, uint objectIndex, uint mip, vec2 uv, vec2 dx, vec2 dy, vec2 axis, uint frame)
{
    uvec2 size = mipSize(object, mip);
    vec2 centre = uv * vec2(size);
    vec2 halfX = 0.5 * push.divisor * dx * vec2(size), halfY = 0.5 * push.divisor * dy * vec2(size);
    vec2 along = axis * vec2(size);
    vec2 extent = abs(halfX) + abs(halfY) + abs(along) + push.reach;
    float tileSize = float(kTileSize);
    ivec2 last = ivec2(tileCount(size)) - 1;
    ivec2 lower = clamp(ivec2(floor((centre - extent) / tileSize)), ivec2(0), last);
    ivec2 upper = clamp(ivec2(floor((centre + extent) / tileSize)), ivec2(0), last);
    ivec2 middle = clamp(ivec2(floor(centre / tileSize)), ivec2(0), last);
    lower = max(lower, middle - kWidest / 2);
    upper = min(upper, middle + kWidest / 2);
    // Long footprints are thin: the separating axis test across them leaves out their box's corners.
    vec2 across = vec2(-along.y, along.x);
    float acrossLength = length(across);
    across = acrossLength > 1e-6 ? across / acrossLength : vec2(0.0);
    float thickness = abs(dot(across, halfX)) + abs(dot(across, halfY)) +
                      (push.reach + 0.5 * tileSize) * (abs(across.x) + abs(across.y));
    for (int y = lower.y; y <= upper.y; ++y)
        for (int x = lower.x; x <= upper.x; ++x) {
            vec2 offset = (vec2(x, y) + 0.5) * tileSize - centre;
            if (abs(dot(across, offset)) <= thickness)
                mark(object, objectIndex, mip, uvec2(x, y), frame);
        }
}

void main()
{
    uint index = listIndex();
    if (index < push.objectCount && objectAt(index).at.mips > 0u) {
        ObjectAt object = objectAt(index);
        for (uint mip = tailMip(object.at.mips); mip < object.at.mips; ++mip) {
            uvec2 tiles = tileCount(mipSize(object, mip));
            for (uint tile = 0u; tile < tiles.x * tiles.y; ++tile)
                mark(object, index, mip, uvec2(tile % tiles.x, tile / tiles.x), view.frame);
        }
    }
    if (index >= push.samples.x * push.samples.y)
        return;
    uvec4 seenBy = imageLoad(seen, ivec2(index % push.samples.x, index / push.samples.x));
    if (seenBy.x == 0u)
        return;
    uint objectIndex = seenBy.x - 1u;
    ObjectAt object = objectAt(objectIndex);
    if (object.at.mips == 0u)
        return;
    vec2 uv = unpackUnorm2x16(seenBy.y), dx = unpackHalf2x16(seenBy.z), dy = unpackHalf2x16(seenBy.w);
    Footprint footprint = footprintOf(dx, dy, vec2(object.at.litSize), view.anisotropy);
    vec2 axis = footprint.taps > 1 ? footprint.axis : vec2(0.0);
    float level = footprint.level + view.levelOffset;
    float finest = mipPosition(object, level - kLevelMargin), coarsest = mipPosition(object, level + kLevelMargin);
    uint first = uint(finest);
    uint last = uint(coarsest) + (coarserWeight(coarsest) > 0.0 ? 1u : 0u);
    for (uint mip = first; mip <= min(last, object.at.mips - 1u); ++mip)
        markBlock(object, objectIndex, mip, uv, dx, dy, axis, view.frame);
    uint fallback = min(last + kFallback, object.at.mips - 1u);
    uvec2 size = mipSize(object, fallback);
    mark(object, objectIndex, fallback, min(uvec2(uv * vec2(size)) / kTileSize, tileCount(size) - 1u), view.frame);
}
