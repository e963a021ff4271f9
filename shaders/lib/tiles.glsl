// Where an object's lumels and tiles lie in its lit texture, and which of its MIPs a footprint reads.
#ifndef LUMEL_TILES_GLSL
#define LUMEL_TILES_GLSL
#include "lib/interface.glsl"

uvec2 mipSize(ObjectAt object, uint mip)
{
    return max(object.at.litSize >> (object.at.litLevel + mip), uvec2(1u));
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

uint tileIndex(ObjectAt object, uint mip, uvec2 tile)
{
    return object.at.tileOffsets[mip] + tile.y * tileCount(mipSize(object, mip)).x + tile.x;
}

uint texelAt(ObjectAt object, uint level, uvec2 lumel)
{
    uint width = max(object.at.litSize.x >> level, 1u);
    return object.at.texels.at[object.at.texelOffsets[level] + lumel.y * width + lumel.x];
}

// Has the tile no surface? Its 8x8 lumels are one lumel three levels coarser, whose gutter indicates surface in
// the tiles around it.
bool tileEmpty(ObjectAt object, uint mip, uvec2 tile)
{
    uvec2 size = mipSize(object, mip);
    if (size.x < kTileSize || size.y < kTileSize)
        return false;
    return texelAt(object, object.at.litLevel + mip + 3u, tile) == 0u;
}

// Frame in which the youngest of the tile's children was lit; 0 when one of them has no light yet. mip: at least 1.
uint childrenLit(ObjectAt object, uint mip, uvec2 tile)
{
    uvec2 fine = tileCount(mipSize(object, mip - 1u));
    uvec2 ratio = mipSize(object, mip - 1u) / mipSize(object, mip);
    uint youngest = 0u;
    for (uint i = 0u; i < 4u; ++i) {
        uvec2 child = tile * ratio + uvec2(i & 1u, i >> 1u);
        if (any(greaterThanEqual(child, fine)) || tileEmpty(object, mip - 1u, child))
            continue;
        uint frame = object.at.tiles.at[tileIndex(object, mip - 1u, child)].lit;
        if (frame == 0u)
            return 0u;
        youngest = max(youngest, frame);
    }
    return youngest;
}

// The state of a tile's light, without its marks and derivation, which other invocations may be changing.
TileState lightState(ObjectAt object, uint index)
{
    TileState state;
    state.eye = object.at.tiles.at[index].eye;
    state.lit = object.at.tiles.at[index].lit;
    state.centre = object.at.tiles.at[index].centre;
    state.radius = object.at.tiles.at[index].radius;
    state.rate = object.at.tiles.at[index].rate;
    state.turned = object.at.tiles.at[index].turned;
    state.change = object.at.tiles.at[index].change;
    state.shown = object.at.tiles.at[index].shown;
    state.marked = 0u;
    state.derive = 0u;
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
float mipPosition(ObjectAt object, float level)
{
    return clamp(level - float(object.at.litLevel), object.at.finest, float(object.at.mips - 1u));
}

// The finer MIP serves the first three quarters of its range alone; over the last one the coarser takes over. Where it
// did from the middle on, pictures and their changes in motion were farther from the reference.
float coarserWeight(float position)
{
    return clamp(4.0 * fract(position) - 3.0, 0.0, 1.0);
}
#endif
