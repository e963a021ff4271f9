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

// A lumel's texel. tileTexels: the second word of its tile.
uint texelOfTile(Texels texels, uint tileTexels, uvec2 lumel)
{
    uint texel = tileTexels;
    if ((tileTexels & kTexelsListed) != 0u) {
        uint first = tileTexels & kTexelListMask, bits = texelListBits(tileTexels);
        uint bit = texelPlace(lumel) * bits;
        texel = texels.at[first + bit / 32u];
        if (bits < 32u)
            texel = texels.at[first + 2u * bits + bitfieldExtract(texel, int(bit % 32u), int(bits))];
    }
    return texel;
}

// The first of a tile's two words in the texel map.
uint tileWords(LitObject object, uint level, uvec2 tile)
{
    uint across = (max(object.litSize.x >> level, 1u) + kTileSize - 1u) / kTileSize;
    return texelOffset(object, level) + 2u * (tile.y * across + tile.x);
}

uint texelAt(LitObject object, uint level, uvec2 lumel)
{
    return texelOfTile(object.texels, object.texels.at[tileWords(object, level, lumel / kTileSize) + 1u], lumel);
}

uint quadMasks(LitObject object, uint mip, uvec2 tile)
{
    return object.texels.at[tileWords(object, object.litLevel + mip, tile)];
}
// Quads of a tile that surface covers whole.
uint wholeQuads(LitObject object, uint mip, uvec2 tile)
{
    return quadMasks(object, mip, tile) >> 16u;
}
// Those that hold surface or gutter.
uint surfaceQuads(LitObject object, uint mip, uvec2 tile)
{
    return quadMasks(object, mip, tile) & kAllQuads;
}

// A lumel is derived from four, a quad from 2 x 2 quads. Which quads of a tile's quarter have all of theirs in `quads`,
// of the child in that corner?
uint parentQuads(uint quads, uvec2 corner)
{
    uint all = quads & quads >> 1u & quads >> 4u & quads >> 5u;
    uint parents = (all & 0x1u) | (all >> 1u & 0x2u) | (all >> 4u & 0x10u) | (all >> 5u & 0x20u);
    return parents << (8u * corner.y + 2u * corner.x);
}

// The four tiles of the finer MIP that a tile of MIP 1 or coarser is made of: their indices, kNoTile beyond its edge.
const uint kNoTile = ~0u;
uvec4 childTiles(LitObject object, uint mip, uvec2 tile)
{
    uvec2 fineSize = mipSize(object, mip - 1u), tiles = tileCount(fineSize), ratio = fineSize / mipSize(object, mip);
    uvec2 child = tile * ratio;
    uint first = tileOffset(object, mip - 1u) + child.y * tiles.x + child.x;
    bool right = child.x + 1u < tiles.x, below = child.y + 1u < tiles.y;
    return uvec4(first, right ? first + 1u : kNoTile, below ? first + tiles.x : kNoTile,
                 right && below ? first + tiles.x + 1u : kNoTile);
}

// Quads that the view needs, as of the given marking.
uint quadsNeeded(LitObject object, uint index, uint marking)
{
    uint needed = object.tiles.at[index].needed;
    return needed >> 16u == marking ? needed & kAllQuads : 0u;
}

// Quads whose children the view all needs.
uint quadsNeededFiner(LitObject object, uint mip, uvec2 tile, uint marking)
{
    uvec4 children = childTiles(object, mip, tile);
    uint quads = 0u;
    for (uint i = 0u; i < 4u; ++i) {
        uint needed = children[i] != kNoTile ? quadsNeeded(object, children[i], marking) : kAllQuads;
        quads |= parentQuads(needed, uvec2(i & 1u, i >> 1u));
    }
    return quads;
}

// What there is to derive a tile from.
struct Children {
    uint held;     // quads whose children all hold light
    uint newer;    // quads whose child was lit after the given frame
    uint youngest; // frame in which the youngest child was lit
};
Children childrenOf(LitObject object, uint mip, uvec2 tile, uint since)
{
    uvec4 tiles = childTiles(object, mip, tile);
    uvec2 first = tile * (mipSize(object, mip - 1u) / mipSize(object, mip));
    Children children = Children(0u, 0u, 0u);
    for (uint i = 0u; i < 4u; ++i) {
        uvec2 corner = uvec2(i & 1u, i >> 1u);
        uint held = kAllQuads; // where there is nothing
        if (tiles[i] != kNoTile) {
            uint holds = object.tiles.at[tiles[i]].held;
            held = ~surfaceQuads(object, mip - 1u, first + corner) | holds | holds >> 16u;
            uint lit = max(object.tiles.at[tiles[i]].lit, object.tiles.at[tiles[i]].derived);
            children.newer |= lit > since ? parentQuads(kAllQuads, corner) : 0u;
            children.youngest = max(children.youngest, lit);
        }
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
    state.rates = object.tiles.at[index].rates;
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
// since a highlight that moved on may come back. 0 = it has no light.
float rateOf(uint rates, uint change)
{
    vec2 turnedAndRate = unpackHalf2x16(rates);
    return max(sqrt(float(change) / kChangeUnit) / max(turnedAndRate.x, 1e-4), 0.5 * turnedAndRate.y);
}

uint ratesOfFirst()
{
    return packHalf2x16(vec2(kTurnedAtFirst, 2.0 * kUnknownRate));
}

// Continuous MIP of the lit texture for a footprint of `level` (of the object's lumel grid).
float mipPosition(LitObject object, float level)
{
    return clamp(level - float(object.litLevel), object.finest, float(object.mips - 1u));
}

// The finer MIP serves most of its range alone; over the last eighth the coarser takes over. Where it did from the middle
// on, pictures and their changes in motion were farther from the reference.
float coarserWeight(float position)
{
    return clamp(8.0 * fract(position) - 7.0, 0.0, 1.0);
}
#endif
