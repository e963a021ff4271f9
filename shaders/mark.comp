#version 460
#extension GL_GOOGLE_include_directive : require
// Plan, first step: every sample of the feedback pass marks the quads that drawing its block of pixels will read,
// at the two MIPs that it blends and, as a fallback, three MIPs coarser. Every object's tail
// MIPs are marked too. A tile enters the list the first time that one of its quads is marked. Markings are numbered; one
// serves as many frames as its samples do.
#include "lib/footprint.glsl"
#include "lib/plan.glsl"

layout(local_size_x = 64) in;
layout(set = 1, binding = 0, rgba32ui) uniform readonly uimage2D seen;

const int kWidest = 32;             // quads along either axis that one sample may mark
// Levels by which what is drawn may differ from the sample: by rounding, and the pixels of a block among themselves.
// Where one reads a MIP that is not marked for it, the other MIP of its blend stands in: lumels without light have no
// weight. A block's margin serves coarser MIPs alone, for finer ones take four times the lumels, and a pixel just finer
// than the sample shows little of them.
const float kRoundingMargin = 0.005;
const float kBlockMargin = 0.1;
const float kStraightReach = 0.5;   // lumels: of a bilinear lookup
const uint kFallback = 3u;          // MIPs
const int kTileQuads = int(kTileSize / kQuadSize); // along either axis

// index: the tile's among the object's.
void mark(LitObject object, uint objectIndex, uint mip, uvec2 tile, uint index, uint quads)
{
    // Reading first spares most atomics.
    uint before = object.tiles.at[index].needed;
    bool listed = before >> 16u == push.marking;
    if (listed && (before & quads) == quads)
        return;
    if (listed || atomicCompSwap(object.tiles.at[index].needed, before, push.marking << 16u | quads) != before) {
        atomicOr(object.tiles.at[index].needed, quads);
        return;
    }
    uint slot = atomicAdd(push.plan.at.marked, 1u);
    if (slot >= push.markCapacity) {
        atomicExchange(object.tiles.at[index].needed, 0u); // coarser tiles may not rely on its light
        atomicAdd(push.plan.at.dropped, 1u);
        return;
    }
    uint waited = before != 0u && before >> 16u == push.marking - 1u ? kPlaceWaited : 0u;
    push.marks.at[slot].tile = Tile(objectIndex, packPlace(mip, tile) | waited);
}

// A row's quads from first to last, of the tile whose first is at `origin`.
uint rowQuads(int first, int last, int origin)
{
    int a = max(first - origin, 0), b = min(last - origin, kTileQuads - 1);
    return b < a ? 0u : ((2u << uint(b - a)) - 1u) << uint(a);
}

// A long footprint is thin: the quads of a tile, whose first is at `origin`, within a strip along its axis.
struct Strip {
    vec2 centre;     // lumels
    float slope;     // lumels along x for one along y
    float halfWidth; // lumels along x
    float last;      // lumel along x
};
uint stripQuads(Strip strip, ivec2 origin)
{
    uint quads = 0u;
    for (int i = 0;;) {
        float top = float((origin.y + i) * int(kQuadSize)) - strip.centre.y;
        vec2 middles = strip.slope * vec2(top, top + float(kQuadSize));
        vec2 ends = vec2(min(middles.x, middles.y), max(middles.x, middles.y)) + vec2(-strip.halfWidth, strip.halfWidth);
        ends = floor(clamp(strip.centre.x + ends, vec2(0.0), vec2(strip.last)) / float(kQuadSize));
        quads |= rowQuads(int(ends.x), int(ends.y), origin.x) << uint(kTileQuads * i);
        if (++i == kTileQuads)
            break;
    }
    return quads;
}

// The quads within `reach` of the parallelogram that the sample stands for.
void markBlock(LitObject object, uint objectIndex, uint mip, vec2 uv, vec2 dx, vec2 dy, vec2 axis, float reach)
{
    uvec2 lumels = mipSize(object, mip);
    vec2 size = vec2(lumels), centre = uv * size;
    float halfBlock = push.divisor > 1.0 ? 0.5 * push.divisor + push.margin : 0.0; // pixels; a pixel reads around its centre
    vec2 halfX = halfBlock * dx * size, halfY = halfBlock * dy * size, along = axis * size;
    vec2 extent = abs(halfX) + abs(halfY) + abs(along) + reach;
    ivec2 lower = ivec2(floor(clamp(centre - extent, vec2(0.0), size - 1.0) / float(kQuadSize)));
    ivec2 upper = ivec2(floor(clamp(centre + extent, vec2(0.0), size - 1.0) / float(kQuadSize)));
    ivec2 middle = ivec2(clamp(centre, vec2(0.0), size - 1.0) / float(kQuadSize));
    lower = max(lower, middle - kWidest / 2);
    upper = min(upper, middle + kWidest / 2);
    float alongLength = length(along);
    bool isLong = alongLength > 1.0;
    vec2 side = alongLength > 1e-6 ? vec2(-along.y, along.x) / alongLength : vec2(0.0);
    float thickness = abs(dot(side, halfX)) + abs(dot(side, halfY)) + reach * (abs(side.x) + abs(side.y));
    float perLumel = abs(side.x) > 0.01 ? 1.0 / side.x : 1e6; // x where the strip's middle is, for each dot
    Strip strip = Strip(centre, -side.y * perLumel, thickness * abs(perLumel), size.x - 1.0);
    ivec2 first = lower / kTileQuads, last = upper / kTileQuads, tile = first;
    uint across = tileCount(lumels).x, firstIndex = tileOffset(object, mip);
    for (int left = (last.x - first.x + 1) * (last.y - first.y + 1);;) {
        ivec2 origin = tile * kTileQuads;
        uint rows = rowQuads(lower.y, upper.y, origin.y);
        uint quads = rowQuads(lower.x, upper.x, origin.x) *
                     ((rows & 1u) | (rows & 2u) << 3u | (rows & 4u) << 6u | (rows & 8u) << 9u);
        if (isLong)
            quads &= stripQuads(strip, origin);
        if (quads != 0u)
            mark(object, objectIndex, mip, uvec2(tile), firstIndex + uint(tile.y) * across + uint(tile.x), quads);
        tile = tile.x == last.x ? ivec2(first.x, tile.y + 1) : tile + ivec2(1, 0);
        if (--left == 0)
            break;
    }
}

// The tail's MIPs are a tile each.
void markTail(LitObject object, uint objectIndex)
{
    for (uint mip = tailMip(object.mips); mip < object.mips; ++mip)
        mark(object, objectIndex, mip, uvec2(0u), tileOffset(object, mip), kAllQuads);
}

void main()
{
    uint index = listIndex();
    if (index < push.objectCount && litObject(index).mips > 0u)
        markTail(litObject(index), index);
    if (index >= push.samples.x * push.samples.y)
        return;
    uvec4 seenBy = imageLoad(seen, ivec2(index % push.samples.x, index / push.samples.x));
    if (seenBy.x == 0u)
        return;
    uint objectIndex = seenBy.x - 1u;
    LitObject object = litObject(objectIndex);
    if (object.mips == 0u)
        return;
    vec2 uv = unpackUnorm2x16(seenBy.y), dx = unpackHalf2x16(seenBy.z), dy = unpackHalf2x16(seenBy.w);
    Footprint footprint = footprintOf(dx, dy, vec2(object.litSize), view.anisotropy);
    // Taps along a long footprint are bilinear. Of a block, some pixels may have a shorter one.
    bool block = push.divisor > 1.0, straight = footprint.taps > (block ? 2 : 1);
    float reach = straight ? min(push.reach, kStraightReach) : push.reach;
    vec2 axis = footprint.axis * (1.0 - 1.0 / float(footprint.taps)); // to the outermost taps
    float level = footprint.level + view.levelOffset;
    float finest = mipPosition(object, level - kRoundingMargin);
    float coarsest = mipPosition(object, level + (block ? kBlockMargin : kRoundingMargin));
    uint first = uint(finest);
    uint last = uint(coarsest) + (coarserWeight(coarsest) > 0.0 ? 1u : 0u);
    // The fallback is the last round of the same loop. There a quad is wider than two blocks of pixels.
    uint coarsestMip = object.mips - 1u, rounds = min(last, coarsestMip) - first + 1u;
    uint fallbacks = index / push.samples.x % 2u == 0u || push.divisor == 1.0 ? 1u : 0u;
    for (uint i = 0u;;) {
        float covers = i < rounds ? 1.0 : 0.0; // or the sample's own point
        uint mip = i < rounds ? first + i : min(last + kFallback, coarsestMip);
        markBlock(object, objectIndex, mip, uv, covers * dx, covers * dy, covers * axis, reach);
        if (++i >= rounds + fallbacks)
            break;
    }
}
