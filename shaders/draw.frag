#version 460
#extension GL_GOOGLE_include_directive : require
// Draw pass: an object in texture space is its lit texture, filtered. No light is evaluated here.
#include "lib/bicubic.glsl"
#include "lib/tiles.glsl"

layout(constant_id = 1) const uint kFilter = kFilterCatmullRom;
layout(push_constant, scalar) uniform Constants { LitPush push; };
layout(set = 1, binding = 1) uniform sampler2DArray lit;
layout(location = 3) in vec2 uv;
layout(location = 0) out vec4 colour;

vec2 sizeOf(uint mip)
{
    return vec2(max(push.size >> mip, uvec2(1u)));
}

// Share of a MIP at uv that may be shown: 0 where its tile has no light yet; rises while the tile fades in.
float shownShare(uint mip)
{
    vec2 size = sizeOf(mip);
    uvec2 tile = uvec2(clamp(uv * size, vec2(0.0), size - 1.0)) / kTileSize;
    uint across = (uint(size.x) + kTileSize - 1u) / kTileSize;
    uint shown = push.tiles.at[push.tileOffsets[mip] + tile.y * across + tile.x].shown;
    return shown == kShownAtOnce ? 1.0
           : shown == 0u         ? 0.0
                                 : min(float(push.draw.frame - shown + 1u) / float(kFadeFrames), 1.0);
}

// The finest MIP from `mip` on that has light here, and its share. On software Vulkan, lanes outside the triangle
// run along with zeros for everything loaded: every loop here must end for them too.
struct Shown {
    uint mip;
    float share;
};
Shown finestShown(uint mip)
{
    float share = 0.0;
    uint last = push.mips - 1u;
    for (; mip < last; ++mip) {
        share = shownShare(mip);
        if (share > 0.0)
            break;
    }
    return Shown(mip, mip == last ? 1.0 : share);
}

LitMip litMip(uint mip)
{
    return LitMip(sizeOf(mip), vec2(mipOrigin(push.size, mip)), 1.0 / vec2(textureSize(lit, 0).xy), float(push.layer));
}

void main()
{
    Footprint footprint = footprintOf(dFdx(uv), dFdy(uv), vec2(push.size), push.anisotropy);
    float position = clamp(footprint.level + push.level, push.finest, float(push.mips - 1u));
    uint wanted = uint(position);
    Shown fine = finestShown(wanted);
    // The coarser MIP takes over with distance, and while the finer one's tiles fade in.
    float coarser = fine.mip == wanted ? coarserWeight(position) : 0.0;
    coarser = max(coarser, 1.0 - fine.share);
    Shown coarse = fine;
    if (coarser > 0.0)
        coarse = finestShown(min(fine.mip + 1u, push.mips - 1u));

    // One loop over the lookups of all taps of both MIPs: pixels that need few wait for none but their
    // neighbours. Along a long footprint the taps overlap, and are bilinear: together they are smooth.
    LitMip fineMip = litMip(fine.mip), coarseMip = litMip(coarse.mip);
    bool along = footprint.taps > 1;
    int lookups = along ? footprint.taps : kFilterLookups[kFilter];
    int fineLookups = coarser < 1.0 ? lookups : 0;
    int all = fineLookups + (coarser > 0.0 ? lookups : 0);
    vec4 sum = vec4(0.0);
    for (int i = 0; i < min(all, 2 * kMostTaps); ++i) {
        bool isFine = i < fineLookups;
        LitMip mip = LitMip(isFine ? fineMip.size : coarseMip.size, isFine ? fineMip.origin : coarseMip.origin,
                            fineMip.inverseBlock, fineMip.layer);
        int lookup = isFine ? i : i - fineLookups;
        float t = (2.0 * float(lookup) + 1.0) / float(footprint.taps) - 1.0;
        vec2 p = (along ? uv + t * footprint.axis : uv) * mip.size;
        Lookup cubic = lookupOf(kFilter, p, lookup);
        vec2 place = along ? p : cubic.place;
        float weight = (isFine ? 1.0 - coarser : coarser) * (along ? 1.0 / float(footprint.taps) : cubic.weight);
        vec4 light = tap(lit, mip, place);
        sum += weight * light;
    }
    colour = vec4(max(sum.rgb / max(sum.a, 0.1), vec3(0.0)), 1.0); // Catmull-Rom's lobes may fall below 0
}
