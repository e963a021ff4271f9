#version 460
#extension GL_GOOGLE_include_directive : require
// Lower levels: a lumel is the average of its four children, weighted by how much surface they cover. A gutter
// lumel takes the mean of the covered lumels near it (dilation), nearer ones weighing more, so that no filter
// tap meets an unlit lumel. Each invocation makes one lumel of the next coarser MIP.
#include "lib/interface.glsl"

layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Constants { LightPush push; };
layout(set = 0, binding = 0, rgba16f) uniform readonly image2DArray fine;
layout(set = 0, binding = 1, rgba16f) uniform writeonly image2DArray coarse;

const int kDilation = 2; // lumels: the reach of a cubic filter's taps

uint coverageOf(Object object, uint level, uvec2 size, ivec2 lumel)
{
    return object.texels.at[object.texelOffsets[level] + uint(lumel.y) * size.x + uint(lumel.x)] >> kTexelCoverageShift;
}

// rgb: weighted sum of the children's radiance, a: sum of weights.
vec4 gather(Object object, uint fineLevel, uvec2 fineSize, uvec2 size, ivec2 lumel)
{
    uvec2 ratio = fineSize / size; // 2, or 1 once an axis has reached one lumel
    vec4 sum = vec4(0.0);
    for (uint j = 0u; j < ratio.y; ++j)
        for (uint i = 0u; i < ratio.x; ++i) {
            ivec2 child = lumel * ivec2(ratio) + ivec2(i, j);
            float weight = float(coverageOf(object, fineLevel, fineSize, child));
            if (weight > 0.0)
                sum += weight * vec4(imageLoad(fine, ivec3(child, object.layer)).rgb, 1.0);
        }
    return sum;
}

void main()
{
    Tile tile = push.tiles.at[gl_WorkGroupID.x];
    Object object = push.view.at.objects.at[tile.object];
    ivec2 lumel = ivec2(tile.x, tile.y) * int(kTileSize) +
                  ivec2(gl_LocalInvocationIndex % kTileSize, gl_LocalInvocationIndex / kTileSize);
    uint level = object.litLevel + push.mip;
    uvec2 size = max(object.litSize >> level, uvec2(1u));
    uvec2 fineSize = max(object.litSize >> (level - 1u), uvec2(1u));
    if (any(greaterThanEqual(lumel, ivec2(size))))
        return;

    vec4 sum = vec4(0.0);
    if (coverageOf(object, level, size, lumel) > 0u) {
        sum = gather(object, level - 1u, fineSize, size, lumel);
    } else {
        for (int j = -kDilation; j <= kDilation; ++j)
            for (int i = -kDilation; i <= kDilation; ++i) {
                ivec2 near = lumel + ivec2(i, j);
                if (any(lessThan(near, ivec2(0))) || any(greaterThanEqual(near, ivec2(size))))
                    continue;
                if (coverageOf(object, level, size, near) == 0u)
                    continue;
                vec4 found = gather(object, level - 1u, fineSize, size, near);
                float distance2 = float(i * i + j * j);
                sum += found / max(found.a, 1e-6) / (distance2 * distance2);
            }
    }
    imageStore(coarse, ivec3(lumel, object.layer), vec4(sum.rgb / max(sum.a, 1e-6), 1.0));
}
