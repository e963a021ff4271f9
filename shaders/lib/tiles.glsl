// Where an object's lumels and tiles lie in its lit texture, and which of its MIPs a footprint reads.
#ifndef LUMEL_TILES_GLSL
#define LUMEL_TILES_GLSL
#include "lib/lit_object.glsl"

uvec2 mipSize(LitObject object, uint mip)
{
    return max(object.litSize >> (object.litLevel + mip), uvec2(1u));
}

uvec2 tileCount(uvec2 size)
{
    return (size + kTileSize - 1u) / kTileSize;
}

uint packPlace(uint mip, uvec2 tile)
{
    return mip << 24u | tile.y << 12u | tile.x;
}

uint placeMip(uint place)
{
    return (place >> 24u) & 0xfu;
}

uvec2 placeTile(uint place)
{
    return uvec2(place & 0xfffu, (place >> 12u) & 0xfffu);
}

uint tileIndex(LitObject object, uint mip, uvec2 tile)
{
    return tileOffset(object, mip) + tile.y * tileCount(mipSize(object, mip)).x + tile.x;
}

uint texelAt(LitObject object, uint level, uvec2 lumel)
{
    uint width = max(object.litSize.x >> level, 1u);
    return object.texels.at[texelOffset(object, level) + lumel.y * width + lumel.x];
}

// Quads of a tile that hold surface or gutter.
uint surfaceQuads(LitObject object, uint mip, uvec2 tile)
{
    uvec2 size = mipSize(object, mip);
    uint first = texelOffset(object, object.litLevel + mip) + size.x * size.y;
    return object.texels.at[first + tile.y * tileCount(size).x + tile.x];
}

// A lumel is derived from four, a quad from 2 x 2 quads. Which quads of a tile's quarter have all of theirs in `quads`,
// of the child in that corner?
uint parentQuads(uint quads, uvec2 corner)
{
    uint all = quads & quads >> 1u & quads >> 4u & quads >> 5u;
    uint parents = (all & 0x1u) | (all >> 1u & 0x2u) | (all >> 4u & 0x10u) | (all >> 5u & 0x20u);
    return parents << (8u * corner.y + 2u * corner.x);
}

// What a tile of MIP 1 or coarser may be derived from.
struct Children {
    uint needed; // quads whose children this frame's view all needs
    uint held;   // quads whose children all hold light
    uint newer;  // quads whose child was lit after the given frame
    uint youngest; // frame in which the youngest child was lit
};
Children childrenOf(LitObject object, uint mip, uvec2 tile, uint since)
{
    uvec2 fineSize = mipSize(object, mip - 1u), fine = tileCount(fineSize), ratio = fineSize / mipSize(object, mip);
    Children children = Children(0u, 0u, 0u, 0u);
    for (uint i = 0u; i < 4u; ++i) {
        uvec2 corner = uvec2(i & 1u, i >> 1u), child = tile * ratio + corner;
        uint needed = kAllQuads, held = kAllQuads; // where there is nothing
        if (all(lessThan(child, fine))) {
            uint index = tileIndex(object, mip - 1u, child), none = ~surfaceQuads(object, mip - 1u, child);
            uint holds = object.tiles.at[index].held;
            needed = none | object.tiles.at[index].needed;
            held = none | holds | holds >> 16u;
            uint lit = max(object.tiles.at[index].lit, object.tiles.at[index].derived);
            children.newer |= lit > since ? parentQuads(kAllQuads, corner) : 0u;
            children.youngest = max(children.youngest, lit);
        }
        children.needed |= parentQuads(needed, corner);
        children.held |= parentQuads(held, corner);
    }
    return children;
}

// The n-th set bit's place, from 0: which quad an invocation works on. Workgroups go over a mask several quads at a time.
uint quadOf(uint quads, uint n)
{
    for (uint i = 0u; i < n; ++i)
        quads &= quads - 1u;
    return uint(findLSB(quads));
}

// Of a quad's four lumels, in its tile.
uvec2 lumelOf(uint quad, uint lumel)
{
    return kQuadSize * uvec2(quad & 3u, quad >> 2u) + uvec2(lumel & 1u, lumel >> 1u);
}

// The state of a tile's light, without its marks, which other invocations may be changing.
TileState lightState(LitObject object, uint index)
{
    TileState state;
    state.eye = object.tiles.at[index].eye;
    state.lit = object.tiles.at[index].lit;
    state.centre = object.tiles.at[index].centre;
    state.radius = object.tiles.at[index].radius;
    state.rate = object.tiles.at[index].rate;
    state.turned = object.tiles.at[index].turned;
    state.change = object.tiles.at[index].change;
    state.shown = object.tiles.at[index].shown;
    state.held = object.tiles.at[index].held;
    state.derived = object.tiles.at[index].derived;
    state.surface = object.tiles.at[index].surface;
    state.cached = object.tiles.at[index].cached;
    state.checked = object.tiles.at[index].checked;
    state.needed = 0u;
    return state;
}

// Tiles in a job's list: those beyond its capacity are not counted.
uint listed(Job job)
{
    return min(job.count, job.capacity);
}

// Angle by which the eye has turned around the tile since it was lit, in radians.
float turnedSince(TileState tile, vec3 eye)
{
    vec3 now = eye - tile.centre, then = tile.eye - tile.centre;
    return length(cross(now, then)) / max(length(now) * length(then), 1e-20);
}

// Of a tile lit for the first time: it is soon lit again, and measured.
const float kUnknownRate = 2.0;

// Display change per radian, as measured when the tile was last lit. What was measured before that counts half,
// since a highlight that moved on may come back.
float rateOf(TileState tile)
{
    if (tile.turned == 0.0)
        return kUnknownRate;
    return max(sqrt(float(tile.change) / kChangeUnit) / max(tile.turned, 1e-4), 0.5 * tile.rate);
}

// Continuous MIP of the lit texture for a footprint of `level` (of the object's lumel grid).
float mipPosition(LitObject object, float level)
{
    return clamp(level - float(object.litLevel), object.finest, float(object.mips - 1u));
}

// The finer MIP serves the first three quarters of its range alone; over the last one the coarser takes over. Where it
// did from the middle on, pictures and their changes in motion were farther from the reference.
float coarserWeight(float position)
{
    return clamp(4.0 * fract(position) - 3.0, 0.0, 1.0);
}
#endif
