// Light pass: a group lights the needed quads of one tile after another of its job's list. Where their surface comes from,
// the shader that includes this says.
#ifndef LUMEL_LIGHT_TILES_GLSL
#define LUMEL_LIGHT_TILES_GLSL
#include "lib/surface_cache.glsl"
#include "lib/tiles.glsl"

// Lanes: 64, or on devices that run 8 at a time 8, which go over a tile two quads at a time. What they have in common is
// then loaded once for the tile and not once for each two.
layout(local_size_x_id = 3) in;
layout(push_constant, scalar) uniform Constants { LightPush push; };
layout(set = 2, binding = 0, rgba16f) uniform image2DArray lit;

// What the surface cache holds of the tile's shadows is all that it needs.
const bool kKnownShadows = (kFeatures & kFeatureKnownShadows) != 0u;

// A lumel's surface, and what is known of the lights that reach it: 8 bits for each shadow map.
struct LumelSurface {
    SurfaceRecord record; // noSurface() where there is none
    uvec2 visible;
    bool changed; // since it was written to the surface cache
};
void beginTile(LitObject object, JobTile job);
LumelSurface surfaceOfLumel(uvec2 lumel);

SurfaceRecord noSurface()
{
    return SurfaceRecord(uvec4[](uvec4(0u), uvec4(0u), uvec4(0u), uvec4(0u)), uvec4(0u));
}

bool isSurface(SurfaceRecord record)
{
    return record.words[1].y != 0u; // its lobe's precision
}

// Squared change in display value from what the lumel held. A square root stands for the display transform.
float changeOf(vec3 before, vec3 after, float exposure)
{
    vec3 d = sqrt(min(after * exposure, vec3(1.0))) - sqrt(min(before * exposure, vec3(1.0)));
    return dot(d, d) / 3.0;
}

uint listedSlot, firstListed, shadowsListed; // of the tile
uint listedLights(uint word)
{
    return word == 0u ? firstListed : push.tiles.at[listedSlot].lights[word];
}

uint listedShadows()
{
    return shadowsListed;
}

uvec2 visibility; // of the lumel, see LumelSurface
float listedVisibility(uint shadow, ShadingPoint point, vec3 toLight)
{
    uint word = shadow < 4u ? visibility.x : visibility.y;
    return float(word >> 8u * (shadow & 3u) & 0xffu) / 255.0;
}

// unknown: bit i, that of the light of view.shadows[i] is to be found.
void findVisibility(ShadingPoint point, uint unknown)
{
    for (; unknown != 0u;) {
        uint shadow = uint(findLSB(unknown)), shift = 8u * (shadow & 3u);
        vec3 toLight = incidentLight(lights[view.shadows[shadow].light], point.position).direction;
        float visible = lightVisibility(view.shadows[shadow], shadow, point.position, point.surface.macroNormal, toLight);
        uint mask = 0xffu << shift, bits = uint(visible * 255.0 + 0.5) << shift;
        if (shadow < 4u)
            visibility.x = (visibility.x & ~mask) | bits;
        else
            visibility.y = (visibility.y & ~mask) | bits;
        unknown &= unknown - 1u;
        if (unknown == 0u)
            break;
    }
}

void keepSurface(uint number, uvec2 lumel, LumelSurface surface)
{
    uvec2 inTile = lumel % kTileSize;
    uint last = kSurfaceWords - 1u;
    if (surface.changed)
        for (uint i = 0u; i < last; ++i)
            push.surfaces.at[surfaceWord(number, push.surfaceCapacity, i, inTile)] = surface.record.words[i];
    if (kTwoLobes && surface.changed)
        push.surfaces.at[surfaceWord(number, push.surfaceCapacity, kSurfaceWords, inTile)] = surface.record.second;
    push.surfaces.at[surfaceWord(number, push.surfaceCapacity, last, inTile)] =
        uvec4(surface.record.words[last].xy, visibility);
}

// Returns the squared change.
float lightLumel(JobTile job, uint flags, uint quad, uvec2 lumel, ivec3 place)
{
    LumelSurface surface = surfaceOfLumel(lumel);
    visibility = surface.visible;
    bool isKnown = !surface.changed && (job.visible >> quad & 1u) != 0u;
    uint unknown = isKnown ? job.shadows >> kMaxShadows : shadowsListed;
    float change = 0.0;
    if (isSurface(surface.record)) {
        ShadingPoint point = shadingPoint(flags, unpackSurface(surface.record));
        if (!kKnownShadows)
            findVisibility(point, unknown);
        vec3 radiance = storable(point.radiance + reflectedFromListed(point));
        // Integers add up to the same sum in every order.
        change = changeOf(imageLoad(lit, place).rgb, radiance, view.exposure);
        imageStore(lit, place, vec4(radiance, 1.0));
    } else {
        imageStore(lit, place, vec4(0.0)); // a former owner's lumels could be not-a-number
    }
    if (!kKnownShadows && job.surface != 0u && (surface.changed || unknown != 0u))
        keepSurface(job.surface, lumel, surface);
    return change;
}

void lightTile(uint slot)
{
    JobTile job = push.tiles.at[slot];
    Tile tile = job.tile;
    listedSlot = slot;
    firstListed = view.lightCount > 0u ? job.lights[0] : 0u; // enlist.comp writes what there is
    shadowsListed = job.shadows & ((1u << kMaxShadows) - 1u);
    LitObject object = litObject(tile.object);
    uint mip = placeMip(tile.place), flags = objectFlags(object);
    uvec2 size = mipSize(object, mip);
    ivec3 origin = ivec3(mipOrigin(mipSize(object, 0u), mip), object.layer);
    beginTile(object, job);
    uint quads = job.quads & kAllQuads, before = job.quads >> 16u;
    float changeUnit = kChangeUnit / float(kQuadLumels * max(bitCount(before), 1u));
    uint change = 0u;
    uint quadsAtOnce = gl_WorkGroupSize.x / kQuadLumels, count = bitCount(quads);
    for (uint i = gl_LocalInvocationIndex / kQuadLumels; i < count;) {
        uint quad = quadOf(quads, i);
        uvec2 lumel = placeTile(tile.place) * kTileSize + lumelOf(quad, gl_LocalInvocationIndex % kQuadLumels);
        if (all(lessThan(lumel, size)))
            change += uint(float(before >> quad & 1u) * changeUnit * lightLumel(job, flags, quad, lumel, origin + ivec3(lumel, 0)));
        i += quadsAtOnce;
        if (i >= count)
            break;
    }
    // Wrong light must not be drawn, even where no sample saw that it is needed.
    uint wrong = job.visible >> 16u, wrongCount = bitCount(wrong);
    for (uint i = gl_LocalInvocationIndex / kQuadLumels; i < wrongCount; i += quadsAtOnce) { // seldom any
        uvec2 lumel = placeTile(tile.place) * kTileSize + lumelOf(quadOf(wrong, i), gl_LocalInvocationIndex % kQuadLumels);
        if (all(lessThan(lumel, size)))
            imageStore(lit, origin + ivec3(lumel, 0), vec4(0.0));
    }
    uint sum = subgroupAdd(change);
    if (subgroupElect() && before != 0u)
        atomicAdd(object.tiles.at[tileIndex(object, mip, placeTile(tile.place))].change, sum);
}

void main()
{
    Job job = push.jobs.at[push.job];
    uint i = gl_WorkGroupID.x, count = listed(job);
    do {
        lightTile(job.first + i);
        i += gl_NumWorkGroups.x;
    } while (i < count);
}
#endif
