#version 460
#extension GL_GOOGLE_include_directive : require
// Lower levels: a lumel is the average of its four children, weighted by how much surface they cover. A gutter
// lumel takes the mean of the covered lumels near it (dilation), nearer ones weighing more, so that no filter
// tap meets an unlit lumel. A group derives one tile after another of its job's list.
#include "lib/tiles.glsl"

layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Constants { LightPush push; };
layout(set = 1, binding = 0, rgba16f) uniform image2DArray lit;

const int kDilation = 2; // lumels: the reach of a cubic filter's taps

uint coverageOf(ObjectAt object, uint mip, uvec2 lumel)
{
    return texelAt(object, object.at.litLevel + mip, lumel) >> kTexelCoverageShift;
}

TileState stateOf(ObjectAt object, uint mip, uvec2 tile)
{
    return object.at.tiles.at[tileIndex(object, mip, tile)];
}

// rgb: weighted sum of the children's radiance, a: sum of weights. Only children in lit tiles.
vec4 gather(ObjectAt object, uint mip, uvec2 lumel)
{
    uvec2 fineSize = mipSize(object, mip - 1u);
    uvec2 ratio = fineSize / mipSize(object, mip); // 2, or 1 once an axis has reached one lumel
    uvec2 origin = mipOrigin(mipSize(object, 0u), mip - 1u);
    vec4 sum = vec4(0.0);
    if (stateOf(object, mip - 1u, lumel * ratio / kTileSize).lit == 0u)
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

// Frame in which the youngest of the tile's children was lit; 0 when one of them has no light yet.
uint childrenLit(ObjectAt object, uint mip, uvec2 tile)
{
    uvec2 fine = tileCount(mipSize(object, mip - 1u));
    uvec2 ratio = mipSize(object, mip - 1u) / mipSize(object, mip);
    uint youngest = 0u;
    for (uint i = 0u; i < 4u; ++i) {
        uvec2 child = tile * ratio + uvec2(i & 1u, i >> 1u);
        if (any(greaterThanEqual(child, fine)) || tileEmpty(object, mip - 1u, child))
            continue;
        uint frame = stateOf(object, mip - 1u, child).lit;
        if (frame == 0u)
            return 0u;
        youngest = max(youngest, frame);
    }
    return youngest;
}

void deriveTile(Tile tile)
{
    ObjectAt object = objectAt(tile.object);
    uint mip = placeMip(tile.place);
    uvec2 origin = placeTile(tile.place);
    uint index = tileIndex(object, mip, origin);
    uint children = childrenLit(object, mip, origin);
    if (children == 0u || children <= object.at.tiles.at[index].lit)
        return; // not yet, or nothing new
    uvec2 lumel = origin * kTileSize +
                  uvec2(gl_LocalInvocationIndex % kTileSize, gl_LocalInvocationIndex / kTileSize);
    if (all(lessThan(lumel, mipSize(object, mip)))) {
        ivec3 place = ivec3(mipOrigin(mipSize(object, 0u), mip) + lumel, object.at.layer);
        imageStore(lit, place, vec4(derive(object, mip, lumel), 1.0));
    }
    barrier(); // all have read `lit` above
    if (gl_LocalInvocationIndex == 0u) {
        uvec2 ratio = mipSize(object, mip - 1u) / mipSize(object, mip);
        TileState child = stateOf(object, mip - 1u, origin * ratio);
        object.at.tiles.at[index].lit = children;
        object.at.tiles.at[index].eye = child.eye;
        object.at.tiles.at[index].centre = child.centre;
        object.at.tiles.at[index].radius = 2.0 * child.radius;
        object.at.tiles.at[index].rate = rateOf(child);
        object.at.tiles.at[index].turned = 1.0;
        object.at.tiles.at[index].change = 0u;
        if (object.at.tiles.at[index].shown == 0u)
            object.at.tiles.at[index].shown = (tile.place & kPlaceWaited) != 0u ? view.frame : kShownAtOnce;
    }
}

void main()
{
    Job job = push.jobs.at[push.job];
    for (uint i = gl_WorkGroupID.x; i < job.count; i += gl_NumWorkGroups.x)
        deriveTile(push.tiles.at[job.first + i].tile);
}
