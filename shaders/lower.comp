#version 460
#extension GL_GOOGLE_include_directive : require
// Lower levels: a lumel is the average of its four children, weighted by how much surface they cover. A gutter
// lumel takes the mean of the covered lumels near it (dilation), nearer ones weighing more, so that no filter
// tap meets an unlit lumel. A group derives one tile after another of its job's list, and all of an object's tail.
#define LUMEL_TILE_STATES coherent // a tail's MIPs are made of each other
#include "lib/tiles.glsl"

layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Constants { LightPush push; };
layout(set = 1, binding = 0, rgba16f) coherent uniform image2DArray lit;

const int kDilation = 2; // lumels: the reach of a cubic filter's taps

uint coverageOf(ObjectAt object, uint mip, uvec2 lumel)
{
    return texelAt(object, object.at.litLevel + mip, lumel) >> kTexelCoverageShift;
}

// rgb: weighted sum of the children's radiance, a: sum of weights. Only children in lit tiles.
vec4 gather(ObjectAt object, uint mip, uvec2 lumel)
{
    uvec2 fineSize = mipSize(object, mip - 1u);
    uvec2 ratio = fineSize / mipSize(object, mip); // 2, or 1 once an axis has reached one lumel
    uvec2 origin = mipOrigin(mipSize(object, 0u), mip - 1u);
    vec4 sum = vec4(0.0);
    if (object.at.tiles.at[tileIndex(object, mip - 1u, lumel * ratio / kTileSize)].lit == 0u)
        return sum;
    for (uint j = 0u; j < ratio.y; ++j)
        for (uint i = 0u; i < ratio.x; ++i) {
            uvec2 child = lumel * ratio + uvec2(i, j);
            float weight = float(coverageOf(object, mip - 1u, child));
            if (weight > 0.0)
                sum += weight * vec4(imageLoad(lit, ivec3(origin + child, object.at.layer)).rgb, 1.0);
        }
    return sum;
}

vec3 derive(ObjectAt object, uint mip, uvec2 lumel)
{
    uvec2 size = mipSize(object, mip);
    vec4 sum = vec4(0.0);
    if (coverageOf(object, mip, lumel) > 0u) {
        sum = gather(object, mip, lumel);
    } else if (texelAt(object, object.at.litLevel + mip, lumel) != 0u) {
        for (int j = -kDilation; j <= kDilation; ++j)
            for (int i = -kDilation; i <= kDilation; ++i) {
                ivec2 near = ivec2(lumel) + ivec2(i, j);
                if (any(lessThan(near, ivec2(0))) || any(greaterThanEqual(near, ivec2(size))))
                    continue;
                if (coverageOf(object, mip, uvec2(near)) == 0u)
                    continue;
                vec4 found = gather(object, mip, uvec2(near));
                float distance2 = float(i * i + j * j);
                sum += found / max(found.a, 1e-6) / (distance2 * distance2);
            }
    }
    return sum.rgb / max(sum.a, 1e-6);
}

void deriveTile(ObjectAt object, uint mip, uvec2 tile)
{
    if (push.waiting != 0u && childrenLit(object, mip, tile) == 0u)
        return; // not yet
    uint local = gl_LocalInvocationIndex;
    uvec2 lumel = tile * kTileSize + uvec2(local % kTileSize, local / kTileSize);
    if (all(lessThan(lumel, mipSize(object, mip)))) {
        ivec3 place = ivec3(mipOrigin(mipSize(object, 0u), mip) + lumel, object.at.layer);
        imageStore(lit, place, vec4(derive(object, mip, lumel), 1.0));
    }
    if (local != 0u)
        return;
    uint index = tileIndex(object, mip, tile);
    uvec2 ratio = mipSize(object, mip - 1u) / mipSize(object, mip);
    TileState child = lightState(object, tileIndex(object, mip - 1u, tile * ratio));
    bool waited = (object.at.tiles.at[index].derive & kDeriveWaited) != 0u;
    object.at.tiles.at[index].lit = childrenLit(object, mip, tile);
    object.at.tiles.at[index].eye = child.eye;
    object.at.tiles.at[index].centre = child.centre;
    object.at.tiles.at[index].radius = 2.0 * child.radius;
    object.at.tiles.at[index].rate = rateOf(child);
    object.at.tiles.at[index].turned = 1.0;
    object.at.tiles.at[index].change = 0u;
    if (object.at.tiles.at[index].shown == 0u)
        object.at.tiles.at[index].shown = waited ? view.frame : kShownAtOnce;
}

void main()
{
    Job job = push.jobs.at[push.job];
    for (uint i = gl_WorkGroupID.x; i < listed(job); i += gl_NumWorkGroups.x) {
        Tile tile = push.tiles.at[job.first + i].tile;
        ObjectAt object = objectAt(tile.object);
        uint mip = placeMip(tile.place), last = mip < derivedTail(object.at.mips) ? mip : object.at.mips - 1u;
        for (; mip <= last; ++mip) {
            uint derive = object.at.tiles.at[tileIndex(object, mip, placeTile(tile.place))].derive;
            if ((derive & kDeriveQueued) != 0u && derive >> kDeriveBits == view.frame)
                deriveTile(object, mip, placeTile(tile.place));
            if (mip < last) {
                memoryBarrierImage();
                memoryBarrierBuffer();
                barrier(); // the next MIP is made of this one
            }
        }
    }
}
