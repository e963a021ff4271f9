#version 460
#extension GL_GOOGLE_include_directive : require
// Draw pass: an object in texture space is its lit texture, filtered. No light is evaluated here.
#include "lib/bicubic.glsl"
#include "lib/tiles.glsl"

layout(constant_id = 1) const uint kFilter = kFilterQuadratic;
const bool kWaiting = (kFeatures & kFeatureWaiting) != 0u;
layout(push_constant, scalar) uniform Constants { LitPush push; };
layout(set = 1, binding = 1) uniform sampler2DArray lit;
layout(location = 3) in vec2 uv;
layout(location = 0) out vec4 colour;

const float kLeastLight = 0.25; // of the weights of all taps: below, a coarser MIP is added

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

// The two MIPs that are blended, and the coarser one's weight. Both may be the same.
struct Blend {
    uint fine, coarse;
    float coarser;
};

// The finest MIP that has light here; the next coarser one that has some takes over with distance, and while the finer
// one's tiles fade in. One loop finds both: most pixels need one round. On software Vulkan, lanes outside the triangle run
// along with zeros for everything loaded: every loop here must end for them too.
Blend shownOf(Blend blend)
{
    uint last = push.mips - 1u;
    Blend shown = Blend(last, last, 0.0);
    bool isFine = true;
    for (uint mip = blend.fine;; ++mip) {
        float share = mip >= last ? 1.0 : shownShare(min(mip, last));
        if (share > 0.0 && isFine)
            shown = Blend(mip, mip, max(mip == blend.fine ? blend.coarser : 0.0, 1.0 - share));
        else if (share > 0.0)
            shown.coarse = mip;
        bool found = share > 0.0 && (!isFine || shown.coarser == 0.0);
        isFine = isFine && share == 0.0;
        if (found || mip >= last)
            break;
    }
    return shown;
}

LitMip litMip(uint mip)
{
    return LitMip(sizeOf(mip), vec2(mipOrigin(push.size, mip)), 1.0 / vec2(textureSize(lit, 0).xy), float(push.layer));
}

// rgb: weighted sum of the light around uv, a: sum of the weights where there is any. Along a long footprint the taps
// are bilinear: they overlap, and a footprint that is longer than a lumel needs no smoother filter.
vec4 filtered(LitMip mip, Footprint footprint)
{
    bool along = footprint.elongation > kRound;
    int lookups = along ? footprint.taps : kFilterLookups[kFilter];
    float share = 1.0 / float(footprint.taps);
    vec2 p = uv * mip.size, axis = footprint.axis * mip.size;
    Kernel kernel = kernelOf(kFilter, p);
    vec4 sum = vec4(0.0);
    for (int i = 0;;) {
        Lookup lookup = lookupOf(kFilter, kernel, i);
        vec2 straight = p + axis * ((2.0 * float(i) + 1.0) * share - 1.0);
        sum += (along ? share : lookup.weight) * tap(lit, mip, along ? straight : lookup.place);
        if (++i >= lookups)
            break;
    }
    return sum;
}

void main()
{
    Footprint footprint = footprintOf(dFdx(uv), dFdy(uv), vec2(push.size), push.anisotropy);
    uint last = push.mips - 1u;
    float position = clamp(footprint.level + push.level, push.finest, float(last));
    Blend blend = Blend(uint(position), min(uint(position) + 1u, last), coarserWeight(position));
    if (kWaiting)
        blend = shownOf(blend);
    // Loops end with their tests: software Vulkan would run a body once more to find the test on its top.
    int levels = blend.coarser > 0.0 ? 2 : 1;
    vec4 sum = vec4(0.0);
    uint mip = blend.fine;
    for (int level = 0;;) {
        float weight = level == 0 ? 1.0 - blend.coarser : level < levels ? blend.coarser : 1.0;
        sum += weight * filtered(litMip(mip), footprint);
        bool isLast = mip == last;
        mip = level == 0 ? blend.coarse : min(mip + 2u, last);
        // Lumels without light weigh nothing. Where no tap met any, coarser MIPs have some; the last one always has. Every
        // other of them, and one bilinear lookup: on software Vulkan, lanes outside small triangles often come here.
        if (++level >= levels && (sum.a > kLeastLight || isLast))
            break;
        footprint.taps = level >= levels ? 1 : footprint.taps;
        footprint.elongation = level >= levels ? 2.0 * kRound : footprint.elongation;
    }
    // Catmull-Rom's lobes may fall below 0.
    colour = vec4(max(sum.rgb / max(sum.a, 0.1), vec3(0.0)), push.draw.opacity);
}
